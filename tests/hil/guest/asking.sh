# Read by guest scripts that ask a running daemon; answers go to $out/told.txt.

# refused WORD COMMAND...: with exit status 1 and this word.
refused() {
  word=$1
  shift
  "$@" >>"$out/told.txt" 2>"$out/refused.txt"
  equal "exit status of $*" $? 1
  grep -q "$word" "$out/refused.txt" || fail "$*: $(cat "$out/refused.txt")"
  cat "$out/refused.txt" >>"$out/told.txt"
}

# told WORD COMMAND...
told() {
  word=$1
  shift
  "$@" >"$out/answer.txt" 2>&1 || fail "$*: $(cat "$out/answer.txt")"
  cat "$out/answer.txt" >>"$out/told.txt"
  grep -q "$word" "$out/answer.txt" || fail "$*: no '$word' in $(cat "$out/answer.txt")"
}
