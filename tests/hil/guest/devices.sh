# CAN sockets and GPIO lines one by one, on what the kernel offers of them; and that first.
. "$ROOT/guest/smoke.sh"

# With echo a frame is confirmed by its driver, and not if that never gets it.
rmmod vcan
insmod /modules/vcan.ko echo=1
ip link add can0 type vcan
ip link set can0 up
can_socket_check can0 >/out/can_socket.txt
status=$?
cat /out/can_socket.txt
[ $status -eq 0 ] || fail "can_socket_check exits with $status"
equal "parts left out" "$(grep -c 'left out' /out/can_socket.txt)" 0

# inputs CHIP: what gpio_check sees of the e-stop (line 0, active low) and the enable line (4).
inputs() {
  gpio_poke "$1" 0 1 >/dev/null
  gpio_poke "$1" 4 0 >/dev/null
  gpio_check "$1" 0l 4 8 12 300 1 >"/out/$1.txt" & check=$!
  sleep 0.1
  gpio_poke "$1" 4 1 >/dev/null
  sleep 0.05
  gpio_poke "$1" 0 0 >/dev/null
  sleep 0.05
  gpio_poke "$1" 0 1 >/dev/null
  wait $check || fail "gpio_check $1 exits with $?"
  cat "/out/$1.txt"
  grep -qx '300 cycles, 0 refused' "/out/$1.txt" || fail "$1 was refused"
  equal "$1: stop, enable, valid" \
    "$(sed -n 's/^[0-9]* \([01] [01] [01]\)$/\1/p' "/out/$1.txt" | tr '\n' ',')" \
    "0 0 1,0 1 1,1 1 1,0 1 1,"
}

inputs gpiochip0
equal "edges" "$(head -n 1 /out/gpiochip0.txt)" "edges of the e-stop: seen"
inputs gpiochip1
equal "no edges" "$(head -n 1 /out/gpiochip1.txt)" "edges of the e-stop: not seen, polled"
