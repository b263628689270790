#include "tactus/canopen/drive_setup.h"

#include "tactus/canopen/canopen.h"
#include "tactus/canopen/cycle_count.h"
#include "tactus/canopen/sdo_abort.h"

namespace tactus {

DriveSetup::DriveSetup(const DriveConfig& drive, const CanopenConfig& canopen, double period_s)
    : steps_(setupSteps(drive, canopen, period_s)),
      sdo_(drive.node_id, cyclesLasting(canopen.sdo_timeout_s, period_s)),
      node_id_(drive.node_id),
      sdo_timeout_cycles_(cyclesLasting(canopen.sdo_timeout_s, period_s)),
      boot_timeout_cycles_(cyclesLasting(canopen.boot_timeout_s, period_s)) {}

void DriveSetup::start() noexcept {
  status_ = Status::kBusy;
  failure_ = {};
  cycles_ = 0;
  is_announced_ = false;
}

void DriveSetup::onBootUp() noexcept {
  step_ = 0;
  if (cycles_ >= boot_timeout_cycles_) return fail(0);
  status_ = Status::kBusy;
  is_announced_ = false;
}

void DriveSetup::receive(const CanFrame& frame) noexcept { sdo_.receive(frame); }

void DriveSetup::update(FrameBatch& out) noexcept {
  if (status_ != Status::kBusy) return;
  ++cycles_;
  if (!is_announced_) {
    out.push(nmtFrame({NmtCommand::kEnterPreOperational, node_id_}));
    is_announced_ = true;
    step_ = 0;
    return beginStep();  // requested in the next cycle, when the drive has changed its state
  }
  ++step_cycles_;
  judgeTransfer();
  sdo_.update(out);
  if (status_ == Status::kDone) out.push(nmtFrame({NmtCommand::kStart, node_id_}));
}

void DriveSetup::beginStep() noexcept {
  const SetupStep& step = steps_[step_];
  step_cycles_ = 0;
  is_changing_ = is_repeated_ = false;
  if (step.kind == SetupStep::Kind::kWrite)
    sdo_.download(step.entry, step.value);
  else
    sdo_.upload(step.entry);
}

void DriveSetup::judgeTransfer() noexcept {
  switch (sdo_.status()) {
    case SdoStatus::kIdle:
    case SdoStatus::kBusy:
      return;
    case SdoStatus::kTimedOut:
      return judgeSilence();
    case SdoStatus::kAborted:
      return judgeAbort();
    case SdoStatus::kDone:
      return judgeAnswer();
  }
}

/// A request may be lost: a bus that still has to confirm frames takes none of this cycle.
void DriveSetup::judgeSilence() noexcept {
  const bool may_still_be_booting = step_ == 0 && cycles_ < boot_timeout_cycles_;
  if (may_still_be_booting) {
    is_announced_ = false;
  } else if (step_ > 0 && !is_repeated_) {
    beginStep();
    is_repeated_ = true;
  } else {
    fail(0);
  }
}

void DriveSetup::judgeAbort() noexcept {
  const SetupStep& step = steps_[step_];
  const std::uint32_t code = sdo_.abortCode();
  const bool is_missing = code == sdo_abort::kObjectMissing || code == sdo_abort::kSubindexMissing;
  const bool is_read_only = code == sdo_abort::kReadOnly || code == sdo_abort::kAccessUnsupported;
  const bool is_write_only = code == sdo_abort::kWriteOnly || code == sdo_abort::kAccessUnsupported;
  const bool is_unread = step.kind == SetupStep::Kind::kEnsure && !is_changing_;
  if (is_write_only && is_unread && step.tellsAllBits()) return write(step.value);
  using Need = SetupStep::Need;
  const Need least = is_missing     ? Need::kIfThere
                     : is_read_only ? Need::kIfWritable
                                    : Need::kIfTaken;
  if (step.need < least) return fail(code);
  nextStep();
}

/// The second half of kEnsure.
void DriveSetup::write(std::uint32_t value) noexcept {
  is_changing_ = true;
  sdo_.download(steps_[step_].entry, value);
}

void DriveSetup::judgeAnswer() noexcept {
  const SetupStep& step = steps_[step_];
  const bool was_written = step.kind == SetupStep::Kind::kWrite || is_changing_;
  const std::uint32_t value = sdo_.value() & step.mask;
  if (was_written || value == step.value) return nextStep();
  if (step.kind == SetupStep::Kind::kEnsure) return write((sdo_.value() & ~step.mask) | step.value);
  if (step_cycles_ < sdo_timeout_cycles_) return sdo_.upload(step.entry);
  fail(0);
  failure_.is_other_value = true;
  failure_.value = value;
  failure_.expected = step.value;
}

void DriveSetup::nextStep() noexcept {
  if (++step_ < steps_.size()) return beginStep();
  status_ = Status::kDone;
}

void DriveSetup::fail(std::uint32_t abort_code) noexcept {
  const ObjectEntry& entry = steps_[step_].entry;
  failure_ = {entry.index, entry.subindex, abort_code};
  status_ = Status::kFailed;
}

}  // namespace tactus
