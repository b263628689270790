# Gains set, undone and reloaded while the arm moves in contact, beside all who look on, and clients
# that mean harm.
. "$ROOT/guest/common.sh"
. "$ROOT/guest/daemon.sh"
. "$ROOT/guest/asking.sh"

export RUNTIME_DIRECTORY=/tmp/run
out=$ROOT/out/control
. "$ROOT/guest/watching.sh"
scene=/tmp/control.yaml

# write_scene DAMPING
write_scene() {
  printf 'extends: %s\ncontroller:\n  damping: %s\n' "$ROOT/tests/hil/scenes/in_contact.yaml" "$1" >$scene
}

mkdir -p $RUNTIME_DIRECTORY
start_buses
write_scene 0.5
start_plant control $scene
permit_start
tactusd $scene -o "$ROOT/out" 2>"$out/tactusd.txt" & daemon=$!
switch_on "$out/tactusd.txt"
start_watching
sleep 0.5

told watched tactus set controller.damping=0.7 task.drift_gain_per_s=4
told 'damping.*0.7 running' tactus diff
told '0.7 -> 0.5' tactus undo
see_stream
if command -v tactus-panel >/dev/null; then work_at_panel; fi  # the build may be without it
refused restart tactus set controller.damping=0.8 controller.order=1
refused 'phase margin\|unstable' tactus set controller.time_constant_s=0.002
refused 'damping' tactus set controller.dampin=1
write_scene 0.9
told '0.5 -> 0.9' tactus reload
told '1.1' tactus set controller.damping=1.1
told written tactus save
grep -q 'damping: 1.1' $scene || fail "not saved: $(cat $scene)"
grep -q 'damping: 0.9' $scene~ || fail "not kept: $(cat $scene~)"
echo '# changed' >>$scene
refused changed tactus save
write_scene much
refused 'control.yaml:3:' tactus reload
refused 'control.yaml:3:' tactusd --reload

hostile_client 1 2000 $RUNTIME_DIRECTORY/control & client=$!
sleep 0.2
hostile_client 2 2000 $RUNTIME_DIRECTORY/control & killed=$!
sleep 0.5
kill -9 $killed
wait $client || fail "hostile_client exits with $?"
told state tactus set controller.damping=0.6 --json

kill $daemon
wait $daemon || fail "tactusd exits with $?"
stop_watching
stop_plant
tactus set controller.damping=0.5 2>>"$out/told.txt"
equal "exit status without a daemon" $? 3
tactus replay "$out/run.ulg" >"$out/replay.txt" || fail "the replay differs: $(cat "$out/replay.txt")"
