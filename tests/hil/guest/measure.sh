# Read by guest scripts that measure a process: what it costs between two points in time.

# loop_thread PID: the thread with a SCHED_FIFO priority.
loop_thread() {
  for task in /proc/"$1"/task/*; do
    case $(chrt -p "${task##*/}") in *SCHED_FIFO*) echo "${task##*/}" && return ;; esac
  done
  fail "process $1 has no thread with SCHED_FIFO"
}

# thread_costs PID THREAD: CPU time in ns, minor and major page faults so far.
thread_costs() {
  cpu_ns=$(cut -d' ' -f1 /proc/"$1"/task/"$2"/schedstat)
  # Fields 10 and 12 of stat, counted behind the name, which may hold spaces.
  faults=$(sed 's/.*) //' /proc/"$1"/task/"$2"/stat | cut -d' ' -f8,10)
  echo "$cpu_ns $faults"
}

# process_costs PID: the same, summed over all its threads.
process_costs() {
  for task in /proc/"$1"/task/*; do thread_costs "$1" "${task##*/}"; done |
    awk '{ cpu += $1; minor += $2; major += $3 } END { printf "%.0f %d %d\n", cpu, minor, major }'
}

# system_calls THREAD SECONDS: "name count" for each call, in the order of names. The thread is
# slowed down meanwhile.
system_calls() {
  strace -c -U name,calls -p "$1" -o /tmp/calls & tracer=$!
  sleep "$2"
  kill -INT $tracer
  wait $tracer
  awk '$2 ~ /^[0-9]+$/ && $1 != "total" { print $1, $2 }' /tmp/calls | sort
}
