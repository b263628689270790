# Every scene of the paper in full length, half a minute each and more.
SCENES=$(cd "$ROOT/config/scenes" && ls -d scenario*.yaml | sed 's/\.yaml$//')
. "$ROOT/guest/scenes.sh"
