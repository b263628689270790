# Read by the guest scripts.

fail() {
  echo "FAILED: $*"
  exit 1
}

# equal WHAT GOT EXPECTED
equal() {
  [ "$2" = "$3" ] || fail "$1: got '$2', expected '$3'"
}

# A short queue, as a real controller's: a burst that copper could not take is refused.
start_buses() {
  for bus in can0 can1 can2 can3; do
    ip link add "$bus" type vcan
    ip link set "$bus" txqueuelen 10 up
  done
}

# never_halt: where nanoseconds count, in the virtual machine; see never_idle.c.
never_halt() {
  [ "$LAYER" != vm ] || chrt --idle 0 never_idle &
}
