# layers: host vm
# `tactus calibrate` on a module's bus: hears it, sends nothing, and says so where there is nothing.
. "$ROOT/guest/common.sh"
. "$ROOT/guest/daemon.sh"

scene=$ROOT/out/noisy.yaml
cat >"$scene" <<END
extends: $ROOT/tests/hil/scenes/in_contact.yaml
simulation: {tactile_module: {noise_N: 0.02}}
END
start_buses
start_plant plant "$scene"
tactus calibrate show "$scene" --duration 3 --json >"$ROOT/out/shown.json" 2>"$ROOT/out/shown.txt"
equal "status of show" $? 0
printf '\n5 +y 0.1\n\n\n' | tactus calibrate record "$scene" -o "$ROOT/out/pushes.yaml" >"$ROOT/out/recorded.txt"
equal "status of record" $? 0
stop_plant

frames_sent() { # /sys of the host does not show interfaces that are made here
  ip -s link show can3 | sed -n '/TX:/{n;s/^ *[0-9]* *\([0-9]*\) .*/\1/p;}'
}
sent=$(frames_sent)
[ -n "$sent" ] || fail "the frames that were sent on can3 are not told"
tactus calibrate show "$scene" --duration 1 2>"$ROOT/out/silent.txt" >/dev/null
equal "status of show on a silent bus" $? 3
equal "frames that show sent" $(($(frames_sent) - sent)) 0
ip link set can3 down
tactus calibrate show "$scene" 2>"$ROOT/out/down.txt" >/dev/null
equal "status of show on a bus that is down" $? 3
