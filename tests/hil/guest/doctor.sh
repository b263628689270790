# Whether `tactus doctor` sees the machine as it is: first in order, then not; and what the plant refuses.
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

# And the plant: it plays on interfaces that are up, alone, as long as they are there.
. "$ROOT/guest/daemon.sh"

# refused TEXT: a plant that is started now ends with the status of a fault, and says so.
refused() {
  tactus plant "$scene" >"$ROOT/out/refused.txt" 2>&1
  equal "status of a plant" $? 3
  grep -q "$1" "$ROOT/out/refused.txt" || fail "no '$1' in $(cat "$ROOT/out/refused.txt")"
}

refused "can3: the interface is down"
ip link set can3 up
start_plant plant "$scene"
refused "can0: another tactus plant"
ip link del can3
wait "$plant"
equal "status of a plant without its interface" $? 3
grep -q "can3: the interface has gone" "$ROOT/out/plant/plant.txt" || fail "$(cat "$ROOT/out/plant/plant.txt")"
