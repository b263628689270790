#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "tactus/commission/commission_config.h"
#include "tactus/commission/joint_findings.h"
#include "tactus/commission/node_uses.h"

namespace tactus {

/// What the engineer is asked.
enum class Asked : std::uint8_t {
  kReady,      ///< may this drive move?                         yes, no
  kDirection,  ///< which way did it go?                         plus, minus, nothing, other joint
  kPlace,      ///< where is the joint?                          number, m or rad
  kJog,        ///< towards its ends, a bit at a time            plus, minus, upper, lower, done
  kEndPlace,   ///< where is the joint, at its end?              number, or unknown
};

struct Question {
  Asked asked = Asked::kReady;
  int joint = 0;
  int bus = 0, node_id = 0;  ///< of the drive
  /// Where the joint is by what is known so far, m or rad.
  std::optional<double> position{};
  bool is_upper = false;    ///< of kEndPlace
  bool is_refused = false;  ///< asked again: what was answered does not fit what is known
};

struct Answer {
  enum class Kind : std::uint8_t {
    kYes,
    kNo,
    kPlus,
    kMinus,
    kNothing,
    kOtherJoint,
    kNumber,
    kUnknown,
    kUpper,
    kLower,
    kDone,
  };
  Kind kind = Kind::kYes;
  double value = 0.0;  ///< of kNumber, m or rad
  int joint = -1;      ///< of kOtherJoint
};

/// How one joint is commissioned, between questions and motions: finds its drive, its sign, counts,
/// offset and ends, and how its drive follows. Knows no frames.
///
/// How many counts a unit has is not known at first, so no motion relies on it: each is so short
/// and slow that it keeps the bounds even if counts were as few as they may be, which is the file's
/// number divided by file_factor. What the engineer then sees and measures says that they are more,
/// and the next motion is longer, by a factor of three at most.
class JointCommission {
 public:
  JointCommission(const CommissionConfig& config, int joint, NodeUses& uses);

  bool isFinished() const noexcept { return step_ == Step::kFinished; }
  const JointTrouble& trouble() const noexcept { return trouble_; }  ///< once it is finished
  const JointFindings& findings() const noexcept { return findings_; }

  /// Null while a motion is due, or all is over.
  const Question* question() const noexcept { return question_ ? &*question_ : nullptr; }
  bool isAnswer(const Answer& answer) const noexcept;
  /// isAnswer(answer); counts: where the drive says that it is now.
  void take(const Answer& answer, double counts);

  const FoundNode& node() const noexcept { return *node_; }
  StrokePlan stroke() const noexcept;  ///< that is due
  void onStroke(const StrokeReport& report);
  void fail(const JointTrouble& trouble);

 private:
  /// Marks that are right to the measuring error lie no further off their line.
  static constexpr double kMostMisfit_errors = 2.0;

  /// Of one motion of a drive to its next, whatever was measured or told: one wrong answer is not
  /// enough to make a motion long.
  static constexpr double kMostGrowth = 3.0;

  /// A unit, by the file and by the drive's own objects, which may not know of a gear behind it.
  struct ToldCounts {
    double fewest, most;
  };

  enum class Step : std::uint8_t { kReady, kProbe, kScale, kJog, kWave, kFinished };

  void tryNext();
  void ask(Asked asked, double counts);
  void askAgain(Asked asked, double counts);
  void takeDirection(const Answer& answer, double counts);
  void takeMark(double q, double counts);
  void takeEndPlace(const Answer& answer, double counts);
  void takeJog(const Answer& answer, double counts);
  void jog(double way, double counts);
  void takeEnd(bool is_upper, double counts);
  void beginWave(double counts);
  void begin(Step step, double distance) noexcept;
  void beginShape(Step step, const StrokeShape& shape) noexcept;
  void finish();
  void chooseScale(const JointScale& measured);
  bool isWide() const noexcept;
  StrokeBounds bounds() const noexcept;
  double assumedCounts(int joint) const noexcept;
  double fewestCounts(int joint) const noexcept;
  ToldCounts toldCounts(int joint) const noexcept;
  std::optional<JointScale> scale() const;
  const MotionBounds& allowed() const noexcept { return config_->bounds(joint_); }

  const CommissionConfig* config_;
  int joint_;
  NodeUses* uses_;
  const FoundNode* node_ = nullptr;
  Step step_ = Step::kReady;
  std::optional<Question> question_;
  JointFindings findings_;
  JointTrouble trouble_;
  StrokeShape shape_;           ///< of the stroke that is due, or of the last one
  StrokeBounds stroke_bounds_;  ///< likewise
  StrokeReport last_stroke_;    ///< of the last one
  bool is_identified_ = false;  ///< it is known that this drive moves this joint
  int seen_sign_ = 0;           ///< by the engineer's eyes
  double unseen_counts_ = 0.0;  ///< the longest probe that nobody saw
  double fewest_ = 0.0;         ///< counts a unit, by marks
  std::vector<Mark> marks_;
  int scale_strokes_ = 0;
  bool is_asked_upper_ = false;
  std::optional<double> upper_counts_, lower_counts_;
  double error_counts_ = 0.0, acceleration_counts_ = 0.0;
};

}  // namespace tactus
