# The paper's scenes in full length: SCENES, or these three.
. "$ROOT/guest/common.sh"
. "$ROOT/guest/daemon.sh"

start_buses
for name in ${SCENES:-scenario1_multi_space scenario2_estimated scenario3_assumed}; do
  run_scene "$name" "$ROOT/config/scenes/$name.yaml" 13
done
