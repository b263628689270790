# Three tactile modules on two buses: a scene in full length, and one module unplugged, in contact and
# not, by an arm that stops then and one that goes on slowly.
. "$ROOT/guest/common.sh"
. "$ROOT/guest/daemon.sh"

# unplug NAME STATUS REACTION INTERFACE FRAME: a frame of each sample is lost from 1.2 s on.
unplug() {
  scene=/tmp/$1.yaml
  {
    echo "extends: $ROOT/tests/hil/scenes/skin_in_contact.yaml"
    echo 'simulation:'
    echo "  troubles: [{kind: drop, from_s: 1.2, until_s: 100, interface: $4, id: $5}]"
  } >"$scene"
  echo "$1"
  start_plant "$1" "$scene"
  tactusd "$scene" --set "robot.module_lost=$3" --duration 3 -o "$ROOT/out" 2>"$ROOT/out/$1/tactusd.txt"
  equal "$1: exit status of the daemon" $? "$2"
  stop_plant
}

start_buses can0 can1 can2 can3 can4
unplug stops 3 stop can4 0x100                       # link 6, which is pushed
unplug stops_untouched 3 stop can3 0x102             # link 3, which is not
unplug slow_in_contact 3 go_on_slowly can4 0x100
unplug goes_on_slowly 0 go_on_slowly can3 0x102
run_scene crops9_skin_two_links "$ROOT/config/scenes/whole_arm/crops9_skin_two_links.yaml" 13
