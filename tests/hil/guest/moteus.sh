# Moteus controllers on CAN FD, behind a vcan of frames of up to 64 bytes.
. "$ROOT/guest/common.sh"
. "$ROOT/guest/daemon.sh"

scene=$ROOT/config/scenes/robots/planar2_moteus.yaml
out=$ROOT/out/planar2_moteus
mkdir -p "$out"
start_buses can0
ip link set can0 down
ip link set can0 mtu 16 up
tactusd "$scene" -o "$ROOT/out/refused" 2>"$out/refused.txt" && fail "tactusd runs on a bus of 8 bytes a frame"
ip link set can0 down
ip link set can0 mtu 72 up
start_candump "$out" can0
run_scene planar2_moteus "$scene" 6
stop_candump
