# Whether the virtual machine has what the other tests stand on.
. "$ROOT/guest/common.sh"

uname -a
case $(uname -v) in *PREEMPT_RT*) ;; *) fail "no PREEMPT_RT kernel" ;; esac

start_buses
for bus in can0 can1 can2 can3; do
  case $(ip link show "$bus") in *"qlen 10"*) ;; *) fail "$bus: not there with a queue of 10" ;; esac
done
candump -L -n 1 can0 >/out/candump.txt &
sleep 0.1
cansend can0 123#DEADBEEF
wait $!
equal "frame" "$(cut -d' ' -f2- /out/candump.txt)" "can0 123#DEADBEEF"

gpiodetect | tee /out/gpiodetect.txt
equal "edge chip" "$(grep -c '^gpiochip0 \[AMDI0030:00\]' /out/gpiodetect.txt)" 1
equal "polled chip" "$(grep -c '^gpiochip1 \[AMDIF031:00\]' /out/gpiodetect.txt)" 1
for chip in gpiochip0 gpiochip1; do
  for level in 0 1 0; do
    gpio_poke "$chip" 4 "$level"
    equal "$chip line 4" "$(gpio_level "$chip" 4)" "$level"
  done
  gpio_hold "$chip" 8=1 &
  sleep 0.1
  case $(gpio_poke "$chip" 8) in *"out=1 driven=1") ;; *) fail "$chip line 8 is not driven" ;; esac
  kill $!
done

gpio_edges gpiochip0 12 --num-events=2 --format='%e %o' >/out/edges.txt &
sleep 0.1
gpio_poke gpiochip0 12 1
gpio_poke gpiochip0 12 0
wait $!
# A falling edge is 0 to the tools of libgpiod 1.x, and 2 to those of 2.x.
equal "edges" "$(sed 's/^2 /0 /' /out/edges.txt | tr '\n' ' ')" "1 12 0 12 "

# In virtual time even the latency is repeatable; 50 us is ten times what it takes.
cyclictest -q -m -p 80 -i 1000 -l 2000 -D 0 | tee /out/cyclictest.txt
maximum=$(sed -n 's/.*Max: *\([0-9]*\)$/\1/p' /out/cyclictest.txt)
[ "$maximum" -lt 50 ] || fail "cyclictest: woken ${maximum} us late"
