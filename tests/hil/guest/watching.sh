# Read by guest scripts: what an engineer looks at a running daemon with, beside it. All that it shows
# goes to files of $out/watching.

watching=$out/watching
panel_port=8470

# start_watching: all that follow a run, and end with it by themselves.
start_watching() {
  mkdir -p "$watching"
  ip link set lo up
  tactus contacts --follow --json >"$watching/contacts.jsonl" 2>"$watching/said.txt" & contacts=$!
  tactus scope --post 1 --json >"$watching/scope.jsonl" 2>>"$watching/said.txt" & scope=$!
  udp_lines 9870 40 >"$watching/stream.jsonl" & lines=$!
  tactus stream --plotjuggler --rate 50 2>>"$watching/said.txt" & stream=$!
}

# see_stream: what PlotJuggler is sent, enough of it.
see_stream() {
  wait $lines || fail "udp_lines exits with $?"
  kill $stream
}

# page FILE PATH [OPTION]...: what the panel answers.
page() {
  file=$watching/$1
  address=http://127.0.0.1:$panel_port$2
  shift 2
  wget -q -O "$file" "$@" "$address"
}

# post FILE PATH JSON [OPTION]...
post() {
  body=$3
  file_and_path="$1 $2"
  shift 3
  # shellcheck disable=SC2086
  page $file_and_path --header 'Content-Type: application/json' --post-data "$body" "$@"
}

# change FILE DO_AND_MORE [OPTION]...: what the panel answers to a change that is asked now.
change() {
  file=$1
  read -r now_s _ </proc/uptime
  request="{\"asked_s\": $now_s, $2}"
  shift 2
  post "$file" /api/do "$request" "$@"
}

# panel_shows FILE: the first event of all that there is, once the panel has read the log and a record
# after it, and knows of the contact that lasts.
panel_shows() {
  for _ in $(seq 50); do
    wget -q -O "$watching/$1" http://127.0.0.1:$panel_port/api/events & events=$!  # without an end
    sleep 0.2
    kill $events
    head -n 1 "$watching/$1" >/tmp/shown
    grep -q '"is_reading":false' /tmp/shown && grep -q '"lasting":\[{' /tmp/shown && return
  done
  fail "the panel does not get to read the log: $(cat "$watching/$1")"
}

# work_at_panel: the page, what runs, what a gain would do, the gain, and back.
work_at_panel() {
  tactus panel --port $panel_port >"$watching/panel.txt" 2>&1 & panel=$!
  wait_for token "$watching/panel.txt"
  token=$(sed -n 's/.*#token=//p' "$watching/panel.txt")
  page index.html / || fail "no page"
  page keys.json /api/keys || fail "no keys"
  panel_shows before.txt
  damping='"values": {"controller.damping": "0.6"}'
  post check.json /api/check "{$damping}" || fail "no check: $(cat "$watching/check.json")"
  set="\"do\": \"set\", $damping"
  change stranger.json "$set" && fail "changed without the token"
  change set.json "$set" --header "X-Tactus-Token: $token" || fail "the panel sets nothing"
  sleep 0.3  # the panel asks five times a second
  panel_shows after.txt
  change undo.json '"do": "undo"' --header "X-Tactus-Token: $token" || fail "nor undoes it"
  kill $panel
  wait $panel || fail "tactus panel exits with $?"
}

# stop_watching: once the daemon has ended.
stop_watching() {
  for follower in $contacts $scope; do
    wait "$follower" || fail "who follows the run exits with $?: $(cat "$watching/said.txt")"
  done
  equal "what those who follow say" "$(cat "$watching/said.txt")" ""
}
