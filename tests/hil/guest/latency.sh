# What a cycle costs, and how late it begins, beside cyclictest in the same kernel.
. "$ROOT/guest/common.sh"
. "$ROOT/guest/daemon.sh"
. "$ROOT/guest/measure.sh"

scene=$ROOT/tests/hil/scenes/in_contact.yaml
cycles=1000

# latency FILE: of cyclictest with the loop's priority and period, as often as the loop. Like the
# loop's its wake-ups lie in the middle between the plant's, and off those of a loop beside it.
latency() {
  cyclictest -q -m -N -p 80 -i 1000 -l $cycles -h 50000 --secaligned=200 >"$ROOT/out/$1"
}

# run_meanwhile SCENE NAME: a daemon that moves, in the background.
run_meanwhile() {
  start_plant "$2" "$1"
  permit_start
  tactusd "$1" -o "$ROOT/out" 2>"/tmp/$2.txt" & daemon=$!
  switch_on "/tmp/$2.txt"
  sleep 0.1
}

end_run() {
  kill $daemon
  wait $daemon || fail "tactusd exits with $?"
  stop_plant
}

never_halt
start_buses
run_enabled in_contact "$scene" $((cycles / 1000))

# The same beside a client that asks a hundred times a second.
mkdir -p /tmp/run
printf 'extends: %s\n' "$scene" >/tmp/asked.yaml
start_plant asked /tmp/asked.yaml
permit_start
RUNTIME_DIRECTORY=/tmp/run tactusd /tmp/asked.yaml --duration $((cycles / 1000)) -o "$ROOT/out" 2>/tmp/asked.txt & daemon=$!
switch_on /tmp/asked.txt
asking_client $((cycles / 10 - 20)) 10000 '{"do":"show"}' /tmp/run/control || fail "asking_client exits with $?"
wait $daemon || fail "asked: tactusd exits with $?"
stop_plant

# A traced cycle takes more than a millisecond.
printf 'extends: %s\nperiod_s: 0.005\n' "$scene" >/tmp/traced.yaml
run_meanwhile /tmp/traced.yaml traced
process_costs $daemon >"$ROOT/out/before.txt"
system_calls "$(loop_thread $daemon)" 1 >"$ROOT/out/calls.txt"
process_costs $daemon >"$ROOT/out/after.txt"
end_run

latency idle.txt

# The same load for cyclictest: buses, plant and a daemon whose loop gives way to it.
robots=$ROOT/config/robots/crops9
sed 's/priority: 80/priority: 75/' "$robots/robot_with_lines.yaml" >"$robots/robot_below.yaml"
printf 'extends: %s\nrobot: %s\n' "$scene" "$robots/robot_below.yaml" >/tmp/below.yaml
run_meanwhile /tmp/below.yaml below
latency loaded.txt
end_run
