# One scene, with contact and GPIO lines: what comes out must be the same in each boot.
. "$ROOT/guest/common.sh"
. "$ROOT/guest/daemon.sh"

never_halt

start_buses
run_enabled in_contact "$ROOT/tests/hil/scenes/in_contact.yaml" 1.5
