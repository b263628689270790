# An hour of it, on a machine that does little else.
LIVES=35 FIRST=200 OTHERS=20
. "$ROOT/guest/soak.sh"
