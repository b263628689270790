# The paper's scenes in full length: SCENES, or the one with most in it.
. "$ROOT/guest/common.sh"
. "$ROOT/guest/daemon.sh"

start_buses
for name in ${SCENES:-scenario2_estimated}; do
  run_scene "$name" "$ROOT/config/scenes/$name.yaml" 13
done
