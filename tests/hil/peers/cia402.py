"""The drive's side of the power state machine of CiA 402-2, written from the standard alone."""

SWITCH_ON_DISABLED = "switch on disabled"
READY_TO_SWITCH_ON = "ready to switch on"
SWITCHED_ON = "switched on"
OPERATION_ENABLED = "operation enabled"
QUICK_STOP_ACTIVE = "quick stop active"
FAULT = "fault"

STATUS_BITS = {
    SWITCH_ON_DISABLED: 0x0040,
    READY_TO_SWITCH_ON: 0x0021,
    SWITCHED_ON: 0x0023,
    OPERATION_ENABLED: 0x0027,
    QUICK_STOP_ACTIVE: 0x0007,
    FAULT: 0x0008,
}
VOLTAGE_ENABLED = 0x0010
REMOTE = 0x0200
FOLLOWS_COMMAND = 0x1000  # mode-specific bit 12 of cyclic synchronous velocity

# Commands of the control word, as (mask, value); bit 7 is an edge and apart.
COMMANDS = {
    "disable voltage": (0x0002, 0x0000),
    "quick stop": (0x0006, 0x0002),
    "shutdown": (0x0007, 0x0006),
    "switch on": (0x000F, 0x0007),
    "enable operation": (0x000F, 0x000F),
}
TRANSITIONS = {
    (SWITCH_ON_DISABLED, "shutdown"): READY_TO_SWITCH_ON,  # 2
    (READY_TO_SWITCH_ON, "switch on"): SWITCHED_ON,  # 3
    (SWITCHED_ON, "enable operation"): OPERATION_ENABLED,  # 4
    (OPERATION_ENABLED, "switch on"): SWITCHED_ON,  # 5: bit 3 falls, "disable operation"
    (SWITCHED_ON, "shutdown"): READY_TO_SWITCH_ON,  # 6
    (READY_TO_SWITCH_ON, "quick stop"): SWITCH_ON_DISABLED,  # 7
    (READY_TO_SWITCH_ON, "disable voltage"): SWITCH_ON_DISABLED,  # 7
    (OPERATION_ENABLED, "shutdown"): READY_TO_SWITCH_ON,  # 8
    (OPERATION_ENABLED, "disable voltage"): SWITCH_ON_DISABLED,  # 9
    (SWITCHED_ON, "quick stop"): SWITCH_ON_DISABLED,  # 10
    (SWITCHED_ON, "disable voltage"): SWITCH_ON_DISABLED,  # 10
    (OPERATION_ENABLED, "quick stop"): QUICK_STOP_ACTIVE,  # 11
    (QUICK_STOP_ACTIVE, "disable voltage"): SWITCH_ON_DISABLED,  # 12
    (QUICK_STOP_ACTIVE, "enable operation"): OPERATION_ENABLED,  # 16
}


class PowerStateMachine:
    def __init__(self):
        self.state = SWITCH_ON_DISABLED  # 0 and 1 are over when the node says boot-up
        self.history = [self.state]
        self._fault_reset_bit = False

    def command(self, control_word):
        """A control word; one transition at most."""
        fault_reset_bit = bool(control_word & 0x0080)
        rises = fault_reset_bit and not self._fault_reset_bit
        self._fault_reset_bit = fault_reset_bit
        if self.state == FAULT:
            if rises:
                self._enter(SWITCH_ON_DISABLED)  # 15
            return
        if fault_reset_bit:
            return
        for name, (mask, value) in COMMANDS.items():
            if control_word & mask == value and (self.state, name) in TRANSITIONS:
                self._enter(TRANSITIONS[self.state, name])
                return

    def stopped(self):
        """A quick stop has come to its end: 12."""
        if self.state == QUICK_STOP_ACTIVE:
            self._enter(SWITCH_ON_DISABLED)

    def fail(self):
        """13 and 14, with a reaction that takes no time."""
        self._enter(FAULT)

    @property
    def status_word(self):
        word = STATUS_BITS[self.state] | REMOTE | VOLTAGE_ENABLED
        return word | FOLLOWS_COMMAND if self.state == OPERATION_ENABLED else word

    def _enter(self, state):
        self.state = state
        self.history.append(state)
