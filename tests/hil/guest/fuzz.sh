# Somebody else sends what only drives and module should, while the arm moves in contact.
. "$ROOT/guest/common.sh"
. "$ROOT/guest/daemon.sh"

scene=$ROOT/tests/hil/scenes/in_contact.yaml
out=$ROOT/out/in_contact
per_second=1000

start_buses
start_plant in_contact "$scene"
permit_start
start_candump "$out" any,200:780
tactusd "$scene" -o "$ROOT/out" 2>"$out/tactusd.txt" & daemon=$!
switch_on "$out/tactusd.txt"
sleep 0.3

random_frames 1 1000 $per_second malformed
equal "after malformed frames" "$(tail -n 1 "$out/tactusd.txt")" "tactusd: running"

# restart: the documented way, left in peace.
restart() {
  runs=$(grep -c running "$out/tactusd.txt")
  line $enable 0 >/dev/null
  sleep 0.2
  line $enable 1 >/dev/null
  wait_for running "$out/tactusd.txt" $((runs + 1))
  sleep 0.1
}

# While it moves, a few frames each time, so that not always the same one stops it.
for seed in 2 3 4 5 6 7; do
  random_frames $seed 20 $per_second hostile
  restart
done

# While the user tries to get it going again and again.
random_frames 10 2000 $per_second hostile & sender=$!
while kill -0 $sender 2>/dev/null; do
  line $enable 0 >/dev/null
  sleep 0.1
  line $enable 1 >/dev/null
  sleep 0.2
done
wait $sender || fail "random_frames exits with $?"
# Drives that are said to have power are cut off, and then a fault is over with its time limit alone.
sleep 5
restart
kill $daemon
wait $daemon || fail "tactusd exits with $?"
stop_candump
stop_plant
