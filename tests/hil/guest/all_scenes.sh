# Every scene of the paper, and ours, in full length.
SCENES=$(cd "$ROOT/config/scenes" && ls -d scenario*.yaml | sed 's/\.yaml$//')
. "$ROOT/guest/scenes.sh"
