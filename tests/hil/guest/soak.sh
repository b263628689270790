# LIVES of the daemon, the first as long as three: what an engineer, a power switch and a stranger do to
# it, drawn by chance; the same for the same LIVES. All that a life leaves is looked at before the next.
. "$ROOT/guest/common.sh"
. "$ROOT/guest/daemon.sh"

export RUNTIME_DIRECTORY=/tmp/run
out=$ROOT/out/soak
scene=/tmp/soak.yaml
socket=$RUNTIME_DIRECTORY/control

# below N: drawn.
below() {
  draws=$(((draws * 1103515245 + 12345) % 2147483648))
  drawn=$((draws / 65536 % $1))
}
draws=2016

# write_scene DAMPING: a log of a few seconds a file; all of them stay, for replay.
write_scene() {
  cat >$scene <<END
extends: $ROOT/tests/hil/scenes/told.yaml
controller: {damping: $1}
log: {max_bytes: 2000000, keep: 99}
END
}

# may COMMAND...: it may be refused.
may() {
  "$@" >>"$out/told.txt" 2>&1
  status=$?
  [ $status -le 1 ] || fail "exit status of $*: $status"
}

damping() {
  below 60
  echo "0.$((40 + drawn))"
}

# wait_mode MODE: until the daemon's last word of its mode is this.
wait_mode() {
  for _ in $(seq 500); do
    case "$(grep '^tactusd: \(running\|enabling\|holding\|fault\|stopping\)' "$said" | tail -n 1)" in
      "tactusd: $1"*) return ;;
    esac
    sleep 0.02
  done
  cat "$said"
  fail "life $life: no $1"
}

# go_on: with the enable line off and on, once the arm has stopped.
go_on() {
  wait_mode fault
  sleep 0.2
  line $enable 0 >/dev/null
  sleep 0.1
  line $enable 1 >/dev/null
  wait_mode running
}

press_e_stop() {
  line $e_stop 0 >/dev/null
  sleep 0.1
  line $e_stop 1 >/dev/null
  go_on
}

switch_off() {
  line $enable 0 >/dev/null
  wait_mode holding
  sleep 0.1
  line $enable 1 >/dev/null
  wait_mode running
}

unplug_bus() {
  ip link set can1 down
  sleep 0.2
  ip link set can1 up
  go_on
}

# Into the obstacle, and back out of it.
touch_it() {
  may tactus move --relative --to 0,-0.12,0
  sleep 0.8
  may tactus move --relative --to 0,0.1,0
  sleep 0.4
}

# Targets until the client dies.
stream() {
  asking_client 100000 2000 '{"do":"stream","to_m":[0,0.004,0],"relative":true}' $socket & client=$!
  sleep 0.3
  kill -9 $client
}

something() {
  below 9
  echo "$drawn" >>"$out/actions.txt"
  case $drawn in
    0) may tactus set "controller.damping=$(damping)" "task.drift_gain_per_s=$((2 + drawn % 3))" ;;
    1) may tactus undo ;;
    2) write_scene "$(damping)"; may tactus reload ;;
    3) touch_it ;;
    4) may tactus hold ;;
    5) press_e_stop ;;
    6) switch_off ;;
    7) unplug_bus ;;
    8) stream ;;
  esac
  hostile_client $((draws % 1000)) 20 $socket || fail "hostile_client exits with $?"
}

# resources WHEN: memory and descriptors that the daemon has.
resources() {
  resident_kB=$(grep VmRSS /proc/$daemon/status | tr -dc 0-9)
  descriptors=$(ls /proc/$daemon/fd | wc -l)
  threads=$(ls /proc/$daemon/task | wc -l)
  echo "$life $1 $resident_kB $descriptors $threads" >>"$out/resources.txt"
}

# look_at_log: whatever comes of a life; logs of an hour have no room on the way out.
look_at_log() {
  (cd $log && tactus replay $(ls | grep '^run\.[0-9]' | sort -t. -k2 -rn) run.ulg) >>"$out/replay.txt" ||
    fail "life $life: the replay differs"
  wc -c $log/run*.ulg | grep run >>"$out/bytes.txt"
  mv "$log/summary.json" "$out/summary.$life.json" 2>/dev/null
  cp "$said" "$out/said.$life.txt"
  rm -r "$log"
}

live() {
  echo "life $life"
  log=/tmp/logs/soak
  said=/tmp/said.txt
  write_scene 0.5
  start_plant soak $scene
  permit_start
  : >$said  # of the life before
  tactusd $scene -o /tmp/logs 2>$said & daemon=$!
  switch_on $said
  sleep 0.5
  resources begins
  for _ in $(seq "$1"); do something; done
  resources ends
  below 3
  if [ "$drawn" = 0 ]; then
    kill -9 $daemon
    wait $daemon
    equal "exit status of a killed daemon" $? 137
  else
    kill $daemon
    wait $daemon || fail "tactusd exits with $?"
  fi
  stop_plant
  look_at_log
}

mkdir -p $RUNTIME_DIRECTORY "$out"
start_buses
for life in $(seq "${LIVES:-2}"); do
  if [ "$life" = 1 ]; then live "${FIRST:-9}"; else live "${OTHERS:-3}"; fi
done
cat /proc/uptime >"$out/uptime.txt"
