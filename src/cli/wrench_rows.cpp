#include "tactus/cli/wrench_rows.h"

#include <fmt/format.h>

namespace tactus {
namespace {

Eigen::Matrix<double, 5, 8> rowsOf(const TactileChannels& channels) {
  Eigen::Matrix<double, 5, 8> rows;
  rows << channels.calibration, channels.moment_x.value_or(TactileChannelRow::Zero());
  return rows / channels.counts_per_N;
}

}  // namespace

std::string channelTable(const ChannelFigures& figures) {
  const auto line = [](const char* name, const auto& cell) {
    std::string text = fmt::format("{:<13}", name);
    for (int i = 0; i < 8; ++i) text += cell(i);
    return text + "\n";
  };
  const auto row = [&](const char* name, const ChannelVector& values) {
    return line(name, [&](int i) { return fmt::format("{:>11.1f}", values[i]); });
  };
  return line("channel", [](int i) { return fmt::format("{:>11}", i); }) +
         row("counts", figures.mean) + row("sigma", figures.sigma) +
         row("drift per s", figures.drift_per_s);
}

Wrench5 wrenchFrom(const TactileChannels& channels, const ChannelVector& counts) {
  return rowsOf(channels) * counts;
}

Wrench5 noiseFrom(const TactileChannels& channels, const ChannelVector& sigma) {
  return (rowsOf(channels).cwiseAbs2() * sigma.cwiseAbs2()).cwiseSqrt();
}

}  // namespace tactus
