# Read by guest scripts that run the daemon against the plant.

# start_plant NAME SCENE: returns once it answers on all buses. Its counters go to
# /out/NAME/plant.json.
start_plant() {
  mkdir -p "$ROOT/out/$1"
  tactus plant --json "$2" >"$ROOT/out/$1/plant.json" 2>"$ROOT/out/$1/plant.txt" & plant=$!
  wait_for ready "$ROOT/out/$1/plant.txt"
}

stop_plant() {
  kill "$plant"
  wait "$plant" || fail "the plant exits with $?"
}

# wait_for TEXT FILE [COUNT]: until so many lines of it hold the text.
wait_for() {
  for _ in $(seq 500); do
    [ "$(grep -c "$1" "$2")" -ge "${3:-1}" ] && return
    sleep 0.02
  done
  cat "$2"
  fail "no '$1' in $2"
}

# Limits on times are those of the program, not of a ramp: accelerations so high that a stop takes a few
# cycles. In the virtual machine alone, whose files are its own.
[ "$LAYER" = host ] ||
  sed -i '/^  acceleration:/s/\b10\b/200/g' "$ROOT/config/robots/crops9/robot_with_lines.yaml"

# The lines of robot_with_lines.yaml; the e-stop is active low.
e_stop=0 enable=4 brake=8

# line LINE [LEVEL]: sets or shows it, with the time.
line() { gpio_poke gpiochip0 "$@"; }

# permit_start: nobody presses the e-stop; the enable line has to be off at first.
permit_start() {
  line $e_stop 1 >/dev/null
  line $enable 0 >/dev/null
}

# switch_on MESSAGES: the enable line, once the daemon waits for it, if it does.
switch_on() {
  wait_for 'ready\|running' "$1"
  line $enable 1 >/dev/null
  wait_for running "$1"
}

# start_candump FOLDER INTERFACE,FILTER...: to FOLDER/candump.log. To a file of candump's choice,
# for what it prints it writes frame by frame.
start_candump() {
  candump_folder=$1
  shift
  (cd "$candump_folder" && exec candump -l -D -r 8000000 "$@" 2>candump.txt) & candump=$!
}

stop_candump() {
  kill "$candump"
  wait "$candump"
  mv "$candump_folder"/candump-*.log "$candump_folder/candump.log"
}

# run_scene NAME SCENE DURATION_S: on the daemon, with the plant behind the buses.
run_scene() {
  echo "$1"
  start_plant "$1" "$2"
  tactusd "$2" --duration "$3" -o "$ROOT/out" || fail "$1: tactusd exits with $?"
  stop_plant
}

# run_enabled NAME SCENE DURATION_S: likewise, with lines.
run_enabled() {
  echo "$1"
  start_plant "$1" "$2"
  permit_start
  tactusd "$2" --duration "$3" -o "$ROOT/out" 2>"$ROOT/out/$1/tactusd.txt" & daemon=$!
  switch_on "$ROOT/out/$1/tactusd.txt"
  wait $daemon || fail "$1: tactusd exits with $?"
  stop_plant
}
