# Whether `tactus doctor` sees the machine as it is: first in order, then not.
. "$ROOT/guest/common.sh"

scene=$ROOT/tests/hil/scenes/in_contact.yaml
examine() {
  tactus doctor "$scene" --duration "$2" --json >"$ROOT/out/$1.json" 2>"$ROOT/out/$1.txt"
  echo $? >"$ROOT/out/$1.status"
}

start_buses
examine in_order 2

ip link set can3 down
ip link set can2 txqueuelen 1000
gpio_edges gpiochip0 4 & monitor=$!
sleep 0.1
examine not_in_order 0.1
kill $monitor
