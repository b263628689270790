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

# scene NAME [TROUBLE]...: the path of a scene with these troubles, times since drives are enabled.
scene() {
  troubled=/tmp/$1.yaml
  shift
  {
    echo "extends: $base"
    [ $# -eq 0 ] || printf 'simulation:\n  troubles:\n'
    [ $# -eq 0 ] || printf '    - {%s}\n' "$@"
  } >"$troubled"
  echo "$troubled"
}

# prepare NAME SCENE: all but the daemon.
prepare() {
  echo "$1"
  out=$ROOT/out/$1
  start_plant "$1" "$2"
  permit_start
}

record() {
  start_candump "$out" can0,0:0,#FFFFFFFF can1,0:0,#FFFFFFFF can2,0:0,#FFFFFFFF
}

# begin SCENE [PROGRAM]: until the arm moves. Somebody watches when its brakes close.
begin() {
  "${2:-tactusd}" "$1" >"$out/stdout.txt" 2>"$out/tactusd.txt" & daemon=$!
  switch_on "$out/tactusd.txt"
  mark brake_before "$(line $brake)"
  line $brake falls >"$out/brake.txt" & watcher=$!
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

# ends STATUS: the daemon is expected to end with it by itself.
ends() {
  wait "$daemon"
  equal "exit status of the daemon" $? "$1"
  kill $watcher 2>/dev/null
  mark brake "$(cat "$out/brake.txt")"
  sleep 0.05
}

finish() {
  ends "$1"
  stop_candump
  stop_plant
}

# where_is BUS NODE: asks a drive of which nothing is heard any more, also one in state stopped.
where_is() {
  cansend "$1" "000#800$2"
  cansend "$1" "60$2#4064600000000000"
}

terminate() {
  mark stop "$(send_signal "$daemon" 15)"
  finish 0
}

# restart: nothing moves before the enable line has been switched off and on.
restart() {
  sleep 0.1
  mark enable_off "$(line $enable 0)"
  sleep 0.1
  mark enable_on "$(line $enable 1)"
  wait_for running "$out/tactusd.txt" 2
  sleep 0.1
}

# begin_with NAME TROUBLE...: what the plant does by itself, as its script says.
begin_with() {
  troubled=$(scene "$@")
  prepare "$1" "$troubled"
  record
  begin "$troubled"
}

# by_plant NAME FAULT SECONDS TROUBLE: with a restart so long after the fault.
by_plant() {
  begin_with "$1" "$4"
  wait_for "$2" "$out/tactusd.txt"
  sleep "$3"
  restart
  terminate
}

start_buses

begin_in_contact e_stop "$base"
mark fault "$(line $e_stop 0)"
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
by_plant bus_off 'fault:' 0.2 "kind: bus_off, interface: can2, $from, until_s: 0.7"
by_plant drive_fault 'fault:' 0.2 "kind: drive_fault, interface: can0, id: 2, $from, until_s: 0.7"
by_plant drive_silent 'fault:' 0.2 "kind: drop, interface: can0, id: 0x181, $from, until_s: 0.7"
by_plant tactile_stale 'holding:' 0.2 "kind: drop, interface: can3, id: 0x100, $from, until_s: 0.7"
by_plant power_cut 'fault:' 1.2 "kind: power_cut, interface: can1, $from, until_s: 1.6"

# Drives that do not obey, or lie about their state.
by_plant boot_up 'fault:' 0.2 "kind: boot_up, interface: can0, id: 2, $from, until_s: 0.7"

begin_with ignore_commands \
  'kind: ignore_commands, interface: can2, id: 2, from_s: 0.55, until_s: 0.9' \
  "kind: drive_fault, interface: can0, id: 2, $from, until_s: 0.7"
wait_for 'fault:' "$out/tactusd.txt"
sleep 0.2
where_is can2 2
sleep 0.1
restart
terminate

begin_with nonsense_status "kind: nonsense_status, interface: can1, id: 3, $from, until_s: 1.3"
wait_for 'fault:' "$out/tactusd.txt"
sleep 0.6
where_is can1 3
sleep 0.1
restart
terminate

frozen=$(scene freeze_feedback \
  'kind: freeze_feedback, interface: can0, id: 2, from_s: 0.7, until_s: 1.4')
begin_in_contact freeze_feedback "$frozen"
mark fault "$(line $e_stop 0)"
sleep 0.6
where_is can0 2
mark released "$(line $e_stop 1)"
sleep 0.1
restart
terminate

# A drive that is not off needs its watch over the heartbeat, also when the daemon ends.
deaf='interface: can1, id: 3, from_s: 0.7, until_s: 100'
begin_in_contact never_off \
  "$(scene never_off "kind: ignore_commands, $deaf" "kind: heartbeat_only, $deaf")"
mark fault "$(send_signal $daemon 15)"
ends 3
where_is can1 3
sleep 0.1
where_is can1 3
sleep 0.05
stop_candump
stop_plant

# Nothing clears this one; a robot without enable line ends by itself.
no_lines=$(scene forbidden_call)
echo "robot: $robots/robot.yaml" >>"$no_lines"
prepare forbidden_call "$no_lines"
begin "$no_lines" forbidden_call_check
record
finish 0
mark fault "$(cat "$out/stdout.txt")"
