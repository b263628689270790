# Faults while the arm moves in contact, each in a run of its own, then the documented way out. All
# frames and the times of what is done here go to the host, which judges them.
. "$ROOT/guest/common.sh"
. "$ROOT/guest/daemon.sh"

base=$ROOT/tests/hil/scenes/in_contact.yaml
robots=$ROOT/config/robots/crops9
contact_s=0.6

# mark WHAT "(TIME)...": for the host.
mark() {
  echo "$1 $2" >>"$out/marks.txt"
}

# scene NAME [TROUBLE]: the path of a scene with this trouble, times since the drives' enabling.
scene() {
  {
    echo "extends: $base"
    [ -z "$2" ] || printf 'simulation:\n  troubles:\n    - {%s}\n' "$2"
  } >"/tmp/$1.yaml"
  echo "/tmp/$1.yaml"
}

# prepare NAME SCENE: all but the daemon.
prepare() {
  echo "$1"
  out=$ROOT/out/$1
  start_plant "$1" "$2"
  permit_motion
}

record() {
  start_candump "$out" can0,0:0,#FFFFFFFF can1,0:0,#FFFFFFFF can2,0:0,#FFFFFFFF
}

# begin SCENE [PROGRAM]: until the arm moves.
begin() {
  "${2:-tactusd}" "$1" >"$out/stdout.txt" 2>"$out/tactusd.txt" & daemon=$!
  wait_for running "$out/tactusd.txt"
}

# Recorded from just before the fault on: to write a frame down takes the machine as long as to send
# it.
begin_in_contact() {
  prepare "$1" "$2"
  begin "$2"
  sleep $contact_s
  record
  sleep 0.05
}

# finish STATUS: the daemon is expected to end with it by itself.
finish() {
  wait "$daemon"
  equal "exit status of the daemon" $? "$1"
  sleep 0.05
  stop_candump
  stop_plant
}

terminate() {
  mark stop "$(send_signal "$daemon" 15)"
  finish 0
}

# restart: nothing moves before the enable line has been switched off and on.
restart() {
  sleep 0.1
  mark enable_off "$(line $enable 0)"
  sleep 0.05
  mark enable_on "$(line $enable 1)"
  wait_for running "$out/tactusd.txt" 2
  sleep 0.1
}

# by_plant NAME FAULT TROUBLE: what the plant does by itself, as its script says.
by_plant() {
  troubled=$(scene "$1" "$3")
  prepare "$1" "$troubled"
  record
  begin "$troubled"
  wait_for "$2" "$out/tactusd.txt"
  sleep "${4:-0.2}"
  restart
  terminate
}

start_buses

begin_in_contact e_stop "$base"
mark brake_before "$(line $brake)"
mark fault "$(line $e_stop 0)"
mark brake "$(line $brake)"
sleep 0.1
mark released "$(line $e_stop 1)"
restart
terminate

begin_in_contact enable_off "$base"
mark fault "$(line $enable 0)"
wait_for holding "$out/tactusd.txt"
sleep 0.05
tactusd "$base" 2>"$out/second.txt"
equal "exit status of a second daemon" $? 3
mark enable_on "$(line $enable 1)"
wait_for running "$out/tactusd.txt" 2
sleep 0.1
terminate

begin_in_contact sigterm "$base"
mark fault "$(send_signal $daemon 15)"
finish 0

# Without SYNC drives tell nothing of their state, so somebody else asks for it, twice.
begin_in_contact sigkill "$base"
mark fault "$(send_signal $daemon 9)"
sleep 0.2
for bus in can0 can1 can2; do
  cansend $bus 000#0100
  cansend $bus 080#
done
sleep 0.05
for bus in can0 can1 can2; do cansend $bus 080#; done
finish 137

begin_in_contact interface_down "$base"
ip link set can1 down
sleep 0.2
ip link set can1 up
restart
terminate

begin_in_contact node_reset "$base"
cansend can0 000#8102
wait_for 'fault:' "$out/tactusd.txt"
sleep 0.1
restart
terminate

# Longer, and the drives would miss SYNC before the loop is back.
sed 's/max_late_cycles: 3/max_late_cycles: 1/' "$robots/robot_with_lines.yaml" \
  >"$robots/robot_impatient.yaml"
impatient=$(scene overrun)
echo "robot: $robots/robot_impatient.yaml" >>"$impatient"
begin_in_contact overrun "$impatient"
mark fault "$(send_signal $daemon 19 2.5 18)"
wait_for 'fault:' "$out/tactusd.txt"
restart
terminate

from="from_s: $contact_s"
by_plant bus_off 'fault:' "kind: bus_off, interface: can2, $from, until_s: 0.7"
by_plant drive_fault 'fault:' "kind: drive_fault, interface: can0, id: 2, $from, until_s: 0.7"
by_plant drive_silent 'fault:' "kind: drop, interface: can0, id: 0x181, $from, until_s: 0.7"
by_plant tactile_stale 'holding:' "kind: drop, interface: can3, id: 0x100, $from, until_s: 0.7"
by_plant power_cut 'fault:' "kind: power_cut, interface: can1, $from, until_s: 5.6" 5.2

# Nothing clears this one; a robot without enable line ends by itself.
no_lines=$(scene forbidden_call)
echo "robot: $robots/robot.yaml" >>"$no_lines"
prepare forbidden_call "$no_lines"
begin "$no_lines" forbidden_call_check
record
finish 0
mark fault "$(cat "$out/stdout.txt")"
