#pragma once

/// The model's parts that no table says: its state, what is asked of it, and a cycle's order.
namespace tactus::model {

inline constexpr const char* kStateText =
    R"(
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
)";

inline constexpr const char* kClaimsText =
    R"(
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
)";

inline constexpr const char* kCycleText =
    R"(
active proctype supervisor() {
  choose(has_line);
  do
  :: atomic {
    if
{faults}    fi;
    if
    :: has_line -> choose(enable)
    :: else -> enable = true
    fi;
    if
{inputs}    fi;
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
)";

}  // namespace tactus::model
