# An hour of it, on a machine that does little else.
LIVES=30 FIRST=200 OTHERS=12
. "$ROOT/guest/soak.sh"
