// Keeps the virtual machine's processor busy when nobody else wants it: to be run with SCHED_IDLE.
//
// QEMU lets virtual time jump ahead while the guest halts, in another thread of its own. On a busy
// host that thread may find the guest halted a moment too early, and one run in three then differed
// from the others by some nanoseconds. Instructions that do nothing cost next to nothing.
int main(void) {
  for (;;) __asm__ volatile(".rept 400\n\tnop\n\t.endr");
}
