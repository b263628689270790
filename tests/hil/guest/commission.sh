# An engineer, played by this script, commissions a joint of a robot in software, whose file has two drives
# swapped and counts and sign of one of them wrong.
. "$ROOT/guest/common.sh"
. "$ROOT/guest/daemon.sh"

out=$ROOT/out/commission
config=/tmp/config
said=$out/said.txt
mkdir -p "$out"
cp -r "$ROOT/config" $config
robot=$config/robots/crops9/robot.yaml

# counts BUS NODE: where the drive says that it is.
counts() {
  candump -n 1 -T 2000 "$1,58$2:7FF" >/tmp/answer.txt & dump=$!
  sleep 0.1
  cansend "$1" "60$2#4064600000000000"
  wait $dump
  set -- $(cut -d']' -f2 /tmp/answer.txt)
  n=$((0x$8$7$6$5))
  [ $n -lt 2147483648 ] || n=$((n - 4294967296))
  echo $n
}

# degrees COUNTS: of the true joint, 1e6 counts/rad.
degrees() { awk -v n="$1" 'BEGIN { printf "%.2f\n", n * 180 / 3.14159265 / 1e6 }'; }

# answer: to what was asked last.
answer() {
  now=$(counts can0 2)
  case $(tail -n 2 "$said") in
    *"Which way"*)
      if [ $((now - last)) -gt 35000 ]; then
        echo +
      elif [ $((last - now)) -gt 35000 ]; then
        echo -
      elif [ $(($(counts can0 3) - other)) -gt 35000 ] || [ $((other - $(counts can0 3))) -gt 35000 ]; then
        echo j3
      else
        echo none
      fi ;;
    *Measure*) degrees "$now" ;;
    *upper*) echo "done" ;;
    *) echo yes ;;
  esac
  last=$now other=$(counts can0 3)
}

start_buses
start_plant commission "$config/scenes/free_motion.yaml"
sed -i '/joint: j2/s/node_id: 2, counts_per_rad: 1e6/node_id: 3, sign: -1, counts_per_rad: 4e6/' $robot
sed -i '/joint: j3/s/node_id: 3/node_id: 2/' $robot
tactus commission "$config/scenes/free_motion.yaml" --scan --json >"$out/scan.json" </dev/null ||
  fail "the scan exits with $?"

mkfifo /tmp/typed
tactus commission "$config/scenes/free_motion.yaml" --joint j2 >"$said" 2>"$out/errors.txt" </tmp/typed & session=$!
exec 3>/tmp/typed
last=$(counts can0 2) other=$(counts can0 3) prompts=0
tactusd "$config/scenes/free_motion.yaml" -o "$ROOT/out/refused" 2>"$out/refused.txt" && fail "tactusd runs beside it"
while kill -0 $session 2>/dev/null; do
  if [ "$(tail -c 2 "$said")" = "> " ] && [ "$(wc -c <"$said")" -gt "$prompts" ]; then
    prompts=$(wc -c <"$said")
    answer >/tmp/line
    cat /tmp/line >&3
    cat /tmp/line >>"$out/typed.txt"
  fi
  sleep 0.1
done
exec 3>&-
wait $session || fail "tactus commission exits with $?: $(cat "$said")"
cp $robot "$out/robot.yaml"
cp $robot~ "$out/robot.yaml~"

# value KEY: of joint j2, as commissioning wrote it.
value() { sed -n "s/.*joint: j2,.*$1: \([-0-9.e+]*\).*/\1/p" $robot; }

# With that the arm moves, from where commissioning left it: that is its home now.
awk -v j2="$(counts can0 2)" -v j3="$(counts can0 3)" -v per_rad="$(value counts_per_rad)" \
  -v offset="$(value offset_rad)" \
  '/^home:/ { split($0, q, ","); sub(q[2] "," q[3], " " j2 / per_rad + offset ", " j3 / 1e6) } { print }' \
  $robot >/tmp/robot.yaml && cp /tmp/robot.yaml $robot
counts can0 2 >"$out/moved.txt"
tactusd "$config/scenes/free_motion.yaml" --duration 2 -o "$ROOT/out/moved" ||
  fail "tactusd exits with $? after it"
counts can0 2 >>"$out/moved.txt"
stop_plant
