#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "tactus/python/bindings.h"
#include "tactus/python/columns.h"
#include "tactus/record/tool_error.h"
#include "tactus/record/ulog_writer.h"
#include "tactus/run/virtual_cycle.h"

namespace py = pybind11;

namespace tactus {
namespace {

template <typename Number>
using Array = py::array_t<Number, py::array::c_style | py::array::forcecast>;

std::string shapeText(const py::array& array) { return py::str(array.attr("shape")); }

void checkShape(const char* name, const py::array& array, const std::vector<py::ssize_t>& expected,
                const char* meaning) {
  bool is_right = array.ndim() == static_cast<py::ssize_t>(expected.size());
  for (std::size_t i = 0; is_right && i < expected.size(); ++i)
    is_right = array.shape(static_cast<py::ssize_t>(i)) == expected[i];
  if (is_right) return;
  const std::string wanted = expected.size() == 1
                                 ? fmt::format("({},)", expected[0])
                                 : fmt::format("({}, {})", expected[0], expected[1]);
  throw py::value_error(
      fmt::format("{}: shape {}, expected {}: {}", name, shapeText(array), wanted, meaning));
}

void checkFinite(const char* name, const Array<double>& array) {
  for (py::ssize_t i = 0; i < array.size(); ++i)
    if (!std::isfinite(array.data()[i]))
      throw py::value_error(
          fmt::format("{}: entry {} is {}, expected finite numbers", name, i, array.data()[i]));
}

/// m or rad, as keys of scenes have it: of more, sine and cosine would be nonsense.
constexpr double kMostTurned = 1e6;

/// A controller in the loop of a program that has a robot of its own.
class ExternalLoop {
 public:
  ExternalLoop(const Scene& scene, const std::optional<Array<double>>& q)
      : shape_(describeLog(scene).shape),
        modules_(static_cast<int>(scene.controller.tactile_modules.size())),
        cycle_(scene, q ? positions("q", *q) : scene.controller.q_start),
        rotation_error_(scene.controller),
        joint_names_(scene.joint_names) {
    const JointLimits& limits = scene.controller.limits;
    if (q) checkWithin("q", *q, limits.lower, limits.upper);
  }

  Array<double> update(const Array<double>& q_measured, const std::optional<Array<double>>& tactile,
                       const std::optional<Array<std::int64_t>>& sequence) {
    RobotInput input = input_;
    input.q_measured = positions("q_measured", q_measured);
    checkCredible(q_measured);
    if (tactile) take(*tactile, input);
    if (sequence) count(*sequence, input);
    input_ = input;  // nothing of an input that was refused stays
    cycle_.update(input_);
    const JointVector& velocity = cycle_.output().velocity;
    return Array<double>(velocity.size(), velocity.data());
  }

  /// The last cycle, as the log would have it.
  Columns record() {
    if (cycle_.time_s() == 0.0)
      throw std::runtime_error("no cycle yet, expected update() before record()");
    CycleRecord record;
    cycle_.fill(input_, Vector3::Zero(), record);
    fillToolError(cycle_.config(), record);
    rotation_error_.fill(record);
    Columns columns(shape_, [](std::string_view) { return true; });
    columns.add(record);
    return columns;
  }

  /// Of the modules' frames in the base frame, [R p; 0 1] each.
  Array<double> modulePoses(const Array<double>& q) const {
    const JointVector configuration = positions("q", q);
    const JointVector furthest = JointVector::Constant(shape_.joints, kMostTurned);
    checkWithin("q", q, -furthest, furthest);
    ChainPose pose;
    cycle_.config().chain.computePose(configuration, pose);
    Array<double> poses({modules_, 4, 4});
    for (int i = 0; i < modules_; ++i) {
      const Pose module = framePose(pose, cycle_.config().tactile_modules[i].link);
      Eigen::Map<Eigen::Matrix<double, 4, 4, Eigen::RowMajor>> matrix(poses.mutable_data(i, 0, 0));
      matrix.setIdentity();
      matrix.topLeftCorner<3, 3>() = module.R_AB;
      matrix.topRightCorner<3, 1>() = module.p_AB;
    }
    return poses;
  }

  const VirtualCycle& cycle() const noexcept { return cycle_; }

 private:
  JointVector positions(const char* name, const Array<double>& q) const {
    checkShape(name, q, {shape_.joints}, "a position of each joint, m or rad");
    checkFinite(name, q);
    return Eigen::Map<const Eigen::VectorXd>(q.data(), shape_.joints);
  }

  void checkWithin(const char* name, const Array<double>& q, const JointVector& lower,
                   const JointVector& upper) const {
    for (int i = 0; i < shape_.joints; ++i) {
      const double least = std::max(lower[i], -kMostTurned);
      const double most = std::min(upper[i], kMostTurned);
      if (q.data()[i] < least || q.data()[i] > most)
        throw py::value_error(fmt::format("{}: joint {} at {}, expected {} to {}", name,
                                          joint_names_[i], q.data()[i], least, most));
    }
  }

  /// An engine's arm may be pushed past its limits, but not far. The daemon's drives stop long
  /// before, by their following error, which the controller's own is without.
  void checkCredible(const Array<double>& q_measured) const {
    const JointLimits& limits = cycle_.config().limits;
    const JointVector range = limits.upper - limits.lower;
    checkWithin("q_measured", q_measured, limits.lower - range, limits.upper + range);
  }

  void take(const Array<double>& tactile, RobotInput& input) const {
    const int width = shape_.has_moment_x ? 5 : 4;
    checkShape("tactile", tactile, {modules_, width},
               width == 5 ? "F_y, F_z (N), M_y, M_z, M_x (Nm) of each tactile module"
                          : "F_y, F_z (N), M_y, M_z (Nm) of each tactile module");
    checkFinite("tactile", tactile);
    for (int i = 0; i < modules_; ++i) {
      const double* const row = tactile.data(i, 0);
      input.tactile[i] = {
          row[0], row[1], row[2], row[3], input.tactile[i].sequence + 1, width == 5 ? row[4] : 0.0};
    }
  }

  void count(const Array<std::int64_t>& sequence, RobotInput& input) const {
    checkShape("sequence", sequence, {modules_}, "the number of each tactile module's sample");
    for (int i = 0; i < modules_; ++i) {
      const std::int64_t number = sequence.data()[i];
      if (number < 0 || number > std::numeric_limits<std::uint32_t>::max())
        throw py::value_error(fmt::format("sequence: entry {} is {}, expected 0 to {}", i, number,
                                          std::numeric_limits<std::uint32_t>::max()));
      input.tactile[i].sequence = static_cast<std::uint32_t>(number);
    }
  }

  RecordShape shape_;
  int modules_;
  VirtualCycle cycle_;
  ToolRotationError rotation_error_;
  std::vector<std::string> joint_names_;
  RobotInput input_;
};

}  // namespace

void bindController(py::module_& module) {
  module.def(
      "make_controller",
      [](const Scene& scene, const std::optional<Array<double>>& q) {
        return std::make_unique<ExternalLoop>(scene, q);
      },
      py::arg("scene"), py::arg("q"));
  classOf<ExternalLoop>(module, "Controller", "A controller behind any robot.")
      .def("update", &ExternalLoop::update, py::arg("q_measured"), py::arg("tactile"),
           py::arg("sequence"))
      .def("record", &ExternalLoop::record)
      .def("module_poses", &ExternalLoop::modulePoses, py::arg("q"))
      .def_property_readonly("time_s",
                             [](const ExternalLoop& loop) { return loop.cycle().time_s(); })
      .def_property_readonly("mode",
                             [](const ExternalLoop& loop) { return modeName(loop.cycle().mode()); })
      .def_property_readonly(
          "fault", [](const ExternalLoop& loop) { return faultName(loop.cycle().end().fault); })
      .def_property_readonly("is_at_rest",
                             [](const ExternalLoop& loop) { return loop.cycle().isAtRest(); });
}

}  // namespace tactus
