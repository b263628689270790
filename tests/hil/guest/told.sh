# A tool that is told where to go: moves, waypoints, a stream that breaks off, a stop in between, a
# daemon that begins where the last one has left the arm, and one that brings it back to the start.
. "$ROOT/guest/common.sh"
. "$ROOT/guest/daemon.sh"
. "$ROOT/guest/asking.sh"

export RUNTIME_DIRECTORY=/tmp/run
out=$ROOT/out/told
scene=$ROOT/tests/hil/scenes/told.yaml

mkdir -p $RUNTIME_DIRECTORY
start_buses
start_plant told "$scene"
permit_start
tactusd "$scene" -o "$ROOT/out" 2>"$out/tactusd.txt" & daemon=$!
switch_on "$out/tactusd.txt"
sleep 0.2

told arrived tactus move --relative --to -,0.05,0.01 --wait
refused 'out of reach' tactus move --to 5,0,0
refused 'does not control' tactus move --rotate 0,0,0.1
refused 'no number' tactus move --to 0.9,north,0.2
cat >/tmp/waypoints.yaml <<END
- {to_m: [0, 0.06, 0], relative: true, pause_s: 0.1}
- {to_m: [0.02, 0, ~], relative: true, speed_m_per_s: 0.05}
- {to_m: [-0.02, -0.05, 0], relative: true}
END
told arrived tactus follow /tmp/waypoints.yaml --wait
printf -- '- {to_m: [0, 0.1, 0], relative: true}\n- {to: [1, 2, 3]}\n' >/tmp/waypoints.yaml
refused 'to_m' tactus follow /tmp/waypoints.yaml

told way tactus move --relative --to 0,0.1,0
sleep 0.5
told holding tactus hold

# Each target some millimetres on, 500 a second.
target='{"do":"stream","to_m":[0,0.008,0],"relative":true}'
asking_client 400 2000 "$target" $RUNTIME_DIRECTORY/control || fail "asking_client exits with $?"
wait_for late "$out/tactusd.txt"
asking_client 100000 2000 "$target" $RUNTIME_DIRECTORY/control & killed=$!
sleep 0.3
kill -9 $killed
wait_for late "$out/tactusd.txt" 2

told way tactus move --relative --to 0,-0.1,0
sleep 0.3
line $enable 0 >/dev/null
wait_for holding "$out/tactusd.txt"
wait_for stopped "$out/tactusd.txt"
refused 'does not run' tactus move --relative --to 0,-0.1,0
sleep 0.1
line $enable 1 >/dev/null
wait_for running "$out/tactusd.txt" 2
sleep 0.3
told arrived tactus move --relative --to 0,-0.2,0 --wait  # out of the contact
hostile_client 3 3000 $RUNTIME_DIRECTORY/control || fail "hostile_client exits with $?"

kill $daemon
wait $daemon || fail "tactusd exits with $?"

# Another daemon begins where this one has left the arm, if its scene says so.
tactusd "$scene" 2>"$out/refused.txt" & daemon=$!
wait_for not_at_start "$out/refused.txt"
kill $daemon
wait $daemon && fail "a daemon that refused to start exits with 0"
tactus where "$scene" --json >"$out/where.json" || fail "tactus where exits with $?"
tactusd "$scene" --set task.commands.start_measured=true -o "$ROOT/out" --name again \
  2>"$out/again.txt" & daemon=$!
wait_for ready "$out/again.txt"
sleep 2
grep -q running "$out/again.txt" && fail "runs by an enable line that was on before"
tactus status | grep -q "for the enable line to be switched off, then on" || fail "status says nothing of the line"
line $enable 0 >/dev/null
sleep 0.1
line $enable 1 >/dev/null
wait_for running "$out/again.txt"
told arrived tactus move --relative --to 0,-0.02,0 --wait
tactus set controller.damping=0.65 || fail "set exits with $?"
tactus reload || fail "reload exits with $?"
kill $daemon
wait $daemon || fail "tactusd exits with $?"

tactusd "$scene" --set task.commands.start_measured=true --set redundancy.posture={} \
  --set redundancy.joint_limit_avoidance.active_fraction=0.2 -o "$ROOT/out" --name home 2>"$out/home.txt" & daemon=$!
wait_for ready "$out/home.txt"
line $enable 0 >/dev/null
sleep 0.1
line $enable 1 >/dev/null
wait_for running "$out/home.txt"
told 'in the posture' tactus move --to-posture --wait
kill $daemon
wait $daemon || fail "tactusd exits with $?"
permit_start
tactusd "$scene" 2>"$out/begins.txt" & daemon=$!
switch_on "$out/begins.txt"
kill $daemon
wait $daemon || fail "tactusd exits with $?"
stop_plant
tactus replay "$ROOT/out/home/run.ulg" >"$out/home_replay.txt" ||
  fail "the replay differs: $(cat "$out/home_replay.txt")"
tactus replay "$ROOT/out/again/run.ulg" >"$out/again_replay.txt" ||
  fail "the replay differs: $(cat "$out/again_replay.txt")"
tactus replay "$out/run.ulg" >"$out/replay.txt" || fail "the replay differs: $(cat "$out/replay.txt")"
