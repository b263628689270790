# Read by the guest scripts.

fail() {
  echo "FAILED: $*"
  exit 1
}

# equal WHAT GOT EXPECTED
equal() {
  [ "$2" = "$3" ] || fail "$1: got '$2', expected '$3'"
}

# start_buses [BUS]...: those of crops9 unless others are named. A short queue, as a real
# controller's: a burst that copper could not take is refused.
start_buses() {
  for bus in ${*:-can0 can1 can2 can3}; do
    ip link add "$bus" type vcan
    ip link set "$bus" txqueuelen 10 up
  done
}

# never_halt: where nanoseconds count, in the virtual machine; see never_idle.c.
never_halt() {
  [ "$LAYER" != vm ] || chrt --idle 0 never_idle &
}


# libgpiod's tools take CHIP LINE up to 1.x, -c CHIP LINE from 2.x on.
has_gpiod_2() {
  gpioget --version | grep -q ' v2'
}

# gpio_level CHIP LINE: 0 or 1
gpio_level() {
  if has_gpiod_2; then gpioget --numeric -c "$1" "$2"; else gpioget "$1" "$2"; fi
}

# gpio_hold CHIP LINE=LEVEL: until it is killed
gpio_hold() {
  if has_gpiod_2; then exec gpioset -c "$1" "$2"; else exec gpioset --mode=signal "$1" "$2"; fi
}

# gpio_edges CHIP LINE [OPTION]...: edges, until it is killed
gpio_edges() {
  chip=$1
  line=$2
  shift 2
  if has_gpiod_2; then exec gpiomon "$@" -c "$chip" "$line"; else exec gpiomon "$@" "$chip" "$line"; fi
}
