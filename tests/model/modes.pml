/* Modes, faults and brakes for SPIN. Written by tests/model/mode_model_test.py --write from
   the tables that the daemon runs from, src/supervisor/mode_table.cpp and
   src/control/fault.cpp; with time limits of a few cycles. Of faults with the same reaction
   there is one: the test shows that the code treats the others alike. */

#define BOOT 0
#define READY 1
#define ENABLING 2
#define RUNNING 3
#define HOLDING 4
#define STOPPING 5
#define FAULT 6
#define OFF 7
#define RETREATING 8
#define NO_REACTION 0
#define RETREAT 1
#define RAMP 2
#define QUICK_STOP 3
#define BRAKE 4
#define NO_FAULT 0
#define TACTILE_INVALID 1
#define COMMAND_NOT_FINITE 3
#define BUS_STALLED 7
#define DRIVE_STATE_LOST 14
#define DRIVE_SETUP_REFUSED 16
#define EMERGENCY_STOP 18
#define BOOT_CYCLES 3
#define ENABLING_CYCLES 4
#define RETREATING_CYCLES 3
#define STOPPING_CYCLES 5
#define BRAKE_CYCLES 1
#define REST_CYCLES 1
#define DEADLINE_CYCLES 2
#define LONGEST_CYCLES 7
#define RAMP_CYCLES 2
#define MISSED_CYCLES 2

/* The state: of modes, of the brakes, and whether the enable line was off since the fault. */
byte mode = BOOT, fault, reaction, cycles, enabled_cycles, rest_cycles;
bool may_clear, is_open, was_off;
bool has_line; /* an enable line; for good */

/* What a cycle is told. Zero between cycles. */
byte seen, seen_reaction; /* a fault */
bool enable, stop, configured, following, drives_off, at_rest, resting, any_holds, moving_on;
bool retreat_over, missed; /* cycles, which a stop's deadline counts */

/* What was asked for in the last cycle, and whether the arm rested, as told or as it must. */
bool is_asked_to_rest, is_asked_to_end, rested;

/* The cycle before. */
hidden byte mode_before, fault_before, reaction_before, was_off_before, was_open;

/* The arm moves at most here: the ramp of a hold or a stop is over in time. */
#define may_move (mode == RUNNING || mode == RETREATING || \
  ((mode == HOLDING || mode == STOPPING) && cycles < RAMP_CYCLES))

inline choose(input) {
  if
  :: input = false
  :: input = true
  fi
}
inline choose_at_rest() {
  if
  :: may_move -> choose(at_rest)
  :: else -> at_rest = true
  fi
}
inline choose_any_holds() {
  if
  :: drives_off -> skip /* what has no power does not hold */
  :: else -> choose(any_holds)
  fi
}

inline note(which, asks_for) {
  if
  :: which != NO_FAULT ->
    if
    :: fault == NO_FAULT -> fault = which
    :: else -> skip
    fi;
    if
    :: reaction < asks_for -> reaction = asks_for
    :: else -> skip
    fi;
    may_clear = false
  :: else -> skip
  fi
}
inline acknowledge() {
  fault = NO_FAULT; reaction = NO_REACTION; may_clear = false
}
inline enter(next) {
  mode = next; cycles = 0; enabled_cycles = 0
}

inline update_mode() {
  if
  :: mode == BOOT ->
    if
    :: stop -> enter(OFF)
    :: else -> if
    :: cycles > BOOT_CYCLES -> note(DRIVE_SETUP_REFUSED, QUICK_STOP); enter(FAULT)
    :: else -> if
    :: fault != NO_FAULT -> enter(FAULT)
    :: else -> if
    :: configured -> enter(READY)
    :: else -> skip
    fi fi fi fi
  :: mode == READY ->
    if
    :: stop -> enter(OFF)
    :: else -> if
    :: fault != NO_FAULT -> enter(FAULT)
    :: else -> if
    :: enable -> enter(ENABLING)
    :: else -> skip
    fi fi fi
  :: mode == ENABLING ->
    if
    :: cycles > ENABLING_CYCLES -> note(DRIVE_STATE_LOST, QUICK_STOP); enter(FAULT)
    :: else -> if
    :: reaction >= QUICK_STOP -> enter(FAULT)
    :: else -> if
    :: stop -> enter(STOPPING)
    :: else -> if
    :: !enable -> enter(STOPPING)
    :: else -> if
    :: fault != NO_FAULT -> enter(STOPPING)
    :: else -> if
    :: following && enabled_cycles >= BRAKE_CYCLES -> enter(RUNNING)
    :: else -> if
    :: following -> enabled_cycles++
    :: else -> if
    :: !following -> enabled_cycles = 0
    :: else -> skip
    fi fi fi fi fi fi fi fi
  :: mode == RUNNING ->
    if
    :: reaction >= QUICK_STOP -> enter(FAULT)
    :: else -> if
    :: stop -> enter(STOPPING)
    :: else -> if
    :: reaction == RAMP -> enter(STOPPING)
    :: else -> if
    :: !enable -> enter(HOLDING)
    :: else -> if
    :: reaction == RETREAT -> enter(RETREATING)
    :: else -> skip
    fi fi fi fi fi
  :: mode == HOLDING ->
    if
    :: reaction >= QUICK_STOP -> enter(FAULT)
    :: else -> if
    :: stop -> enter(STOPPING)
    :: else -> if
    :: reaction == RAMP -> enter(STOPPING)
    :: else -> if
    :: !has_line && at_rest && fault != NO_FAULT -> enter(STOPPING)
    :: else -> if
    :: !enable && has_line && seen == NO_FAULT -> may_clear = true
    :: else -> if
    :: enable && has_line && at_rest && seen == NO_FAULT && may_clear -> acknowledge(); enter(RUNNING)
    :: else -> skip
    fi fi fi fi fi fi
  :: mode == STOPPING ->
    if
    :: cycles > STOPPING_CYCLES -> note(DRIVE_STATE_LOST, QUICK_STOP); enter(FAULT)
    :: else -> if
    :: reaction >= QUICK_STOP -> enter(FAULT)
    :: else -> if
    :: at_rest && drives_off && fault != NO_FAULT -> enter(FAULT)
    :: else -> if
    :: stop && at_rest && drives_off -> enter(OFF)
    :: else -> if
    :: at_rest && drives_off -> enter(READY)
    :: else -> skip
    fi fi fi fi fi
  :: mode == FAULT ->
    if
    :: stop && (drives_off || cycles > STOPPING_CYCLES) -> enter(OFF)
    :: else -> if
    :: !has_line && (drives_off || cycles > STOPPING_CYCLES) -> enter(OFF)
    :: else -> if
    :: !enable && has_line && (drives_off || cycles > STOPPING_CYCLES) && seen == NO_FAULT -> may_clear = true
    :: else -> if
    :: enable && has_line && (drives_off || cycles > STOPPING_CYCLES) && seen == NO_FAULT && may_clear -> acknowledge(); enter(BOOT)
    :: else -> skip
    fi fi fi fi
  :: mode == OFF ->
    skip
  :: mode == RETREATING ->
    if
    :: reaction >= QUICK_STOP -> enter(FAULT)
    :: else -> if
    :: stop -> enter(STOPPING)
    :: else -> if
    :: reaction == RAMP -> enter(STOPPING)
    :: else -> if
    :: !enable -> enter(HOLDING)
    :: else -> if
    :: retreat_over -> enter(HOLDING)
    :: else -> if
    :: cycles > RETREATING_CYCLES -> enter(HOLDING)
    :: else -> skip
    fi fi fi fi fi fi
  fi
}

inline update_brake() {
  if
  :: mode == STOPPING && resting ->
    if
    :: rest_cycles <= REST_CYCLES -> rest_cycles++
    :: else -> skip
    fi
  :: else -> rest_cycles = 0
  fi;
  if
  :: reaction != BRAKE && mode == ENABLING ->
    is_open = (following)
  :: reaction != BRAKE && mode == RUNNING ->
    is_open = (true)
  :: reaction != BRAKE && mode == RETREATING ->
    is_open = (true)
  :: reaction != BRAKE && mode == HOLDING ->
    is_open = (true)
  :: reaction != BRAKE && mode == STOPPING ->
    is_open = (is_open && rest_cycles == 0)
  :: reaction != BRAKE && mode == FAULT ->
    is_open = (is_open && any_holds && !moving_on && cycles < DEADLINE_CYCLES)
  :: else -> is_open = false
  fi
}

inline observe() {
  if
  :: seen != NO_FAULT || (fault_before == NO_FAULT && fault != NO_FAULT) || mode == RUNNING ->
    was_off = false
  :: else -> skip
  fi;
  if
  :: !enable && seen == NO_FAULT -> was_off = true
  :: else -> skip
  fi;
  is_asked_to_rest = stop || !enable || fault != NO_FAULT;
  is_asked_to_end = stop;
  rested = at_rest || !may_move
}

inline check() {
  /* no motion without enable, on demand, or with a fault */
  assert(enable || (mode != RUNNING && mode != RETREATING));
  assert(enable || mode != ENABLING || mode_before == ENABLING);
  assert(!stop || (mode != RUNNING && mode != RETREATING));
  assert(fault == NO_FAULT || mode != RUNNING);
  assert(mode_before != HOLDING || mode != RUNNING || was_off_before);
  /* no fault is lost: the first one stays until the line was off, and is on, and the cause gone */
  assert(seen == NO_FAULT || fault != NO_FAULT);
  assert(fault_before == NO_FAULT || fault == fault_before ||
    (fault == NO_FAULT && has_line && was_off_before && enable && seen == NO_FAULT));
  /* its reaction only grows harsher */
  assert(reaction >= seen_reaction);
  assert(reaction >= reaction_before || fault == NO_FAULT);
  assert(reaction < QUICK_STOP || mode == FAULT || mode == OFF);
  assert(reaction != RAMP || mode == STOPPING || mode == FAULT || mode == OFF);
  /* brakes: closed at every end, open only where drives follow, never opened by a stop */
  assert(!is_open || (mode != BOOT && mode != READY && mode != OFF));
  assert(!is_open || was_open || (mode != STOPPING && mode != FAULT));
  assert(!is_open || mode != ENABLING || following);
  assert(!is_open || reaction != BRAKE);
  assert(!is_open || mode != FAULT || cycles < DEADLINE_CYCLES);
  assert(!is_open || mode != FAULT || (any_holds && !moving_on));
  assert(is_open || (mode != RUNNING && mode != RETREATING && mode != HOLDING))
}

/* Whatever comes: what is asked to rest rests; what is asked to end ends; a quick stop closes the
   brakes; a stop ends at drives off, or as a fault. */
ltl rests { [] (is_asked_to_rest -> <> rested) }
ltl ends { (<> [] is_asked_to_end) -> <> (mode == OFF) }
ltl closes { [] ((reaction >= QUICK_STOP || mode == STOPPING) -> <> !is_open) }
ltl leaves { [] ((mode == STOPPING || mode == RETREATING) -> <> (mode != STOPPING && mode != RETREATING)) }

active proctype supervisor() {
  choose(has_line);
  do
  :: atomic {
    if
    :: seen = NO_FAULT; seen_reaction = NO_REACTION
    :: seen = TACTILE_INVALID; seen_reaction = RETREAT
    :: seen = COMMAND_NOT_FINITE; seen_reaction = RAMP
    :: seen = BUS_STALLED; seen_reaction = QUICK_STOP
    :: seen = DRIVE_STATE_LOST; seen_reaction = QUICK_STOP
    :: seen = DRIVE_SETUP_REFUSED; seen_reaction = QUICK_STOP
    :: seen = EMERGENCY_STOP; seen_reaction = BRAKE
    fi;
    if
    :: has_line -> choose(enable)
    :: else -> enable = true
    fi;
    if
    :: mode == BOOT ->
      skip; choose(stop); choose(configured); choose_any_holds(); choose(moving_on)
    :: mode == READY ->
      skip; choose(stop); choose(following); choose_any_holds(); choose(moving_on)
    :: mode == ENABLING ->
      skip; choose(stop); choose(following); choose(resting); choose_any_holds(); choose(moving_on)
    :: mode == RUNNING ->
      skip; choose(stop); choose(resting); choose_any_holds(); choose(moving_on)
    :: mode == HOLDING ->
      skip; choose(stop); choose_at_rest(); choose(resting); choose_any_holds(); choose(moving_on)
    :: mode == STOPPING ->
      skip; choose(stop); choose(drives_off); choose_at_rest(); choose(resting); choose_any_holds(); choose(moving_on); choose(missed)
    :: mode == FAULT ->
      skip; choose(stop); choose(drives_off); choose_any_holds(); choose(moving_on); choose(missed)
    :: mode == OFF ->
      skip
    :: mode == RETREATING ->
      skip; choose(stop); choose(resting); choose_any_holds(); choose(moving_on); choose(retreat_over); choose(missed)
    fi;
    d_step {
      mode_before = mode; fault_before = fault; reaction_before = reaction;
      was_off_before = was_off; was_open = is_open;
      printf("%d %d %d %d %d %d %d %d %d %d  ", has_line, mode, fault, reaction, may_clear,
        cycles, enabled_cycles, is_open, rest_cycles, was_off);
      note(seen, seen_reaction);
      cycles = cycles + 1 + (missed -> MISSED_CYCLES : 0);
      update_mode();
      if
      :: cycles > LONGEST_CYCLES -> cycles = LONGEST_CYCLES
      :: else -> skip
      fi;
      update_brake();
      observe();
      check();
      printf("%d %d  ", seen, enable + 2 * stop + 4 * configured + 8 * following +
        16 * drives_off + 32 * at_rest + 64 * resting + 128 * any_holds + 256 * moving_on +
        512 * retreat_over + 1024 * missed);
      printf("%d %d %d %d %d %d %d %d %d\n", mode, fault, reaction, may_clear, cycles,
        enabled_cycles, is_open, rest_cycles, was_off);
      seen = NO_FAULT; seen_reaction = NO_REACTION; enable = false; stop = false;
      configured = false; following = false; drives_off = false; at_rest = false;
      resting = false; any_holds = false; moving_on = false; retreat_over = false;
      missed = false
    }
  }
  od
}
