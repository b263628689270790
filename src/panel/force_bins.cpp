#include "tactus/panel/force_bins.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace tactus {
namespace {

/// Numbers as short as a page needs them: 0.1 mN, 0.1 ms.
Json rounded(double value) {
  if (!std::isfinite(value)) return nullptr;
  return std::round(1e4 * value) / 1e4;
}

}  // namespace

void extend(ForceBin& bin, const ForceBin& later) noexcept {
  bin.to_s = later.to_s;
  for (std::size_t i = 0; i < bin.least_N.size(); ++i) {
    bin.least_N[i] = std::min(bin.least_N[i], later.least_N[i]);
    bin.most_N[i] = std::max(bin.most_N[i], later.most_N[i]);
  }
}

void ForceBins::add(double t_s, std::span<const double> force_N) {
  // A clock that goes back is of another run.
  const bool is_next =
      has_present_ && (t_s < present_.to_s || t_s >= present_.from_s + width_s_ - 1e-9);
  if (is_next) complete_.push_back(present_);
  if (is_next || !has_present_) present_ = ForceBin(t_s);
  has_present_ = true;
  ForceBin cycle(t_s);
  for (std::size_t i = 0; i < force_N.size() && i < cycle.least_N.size(); ++i)
    if (std::isfinite(force_N[i])) cycle.least_N[i] = cycle.most_N[i] = force_N[i];
  extend(present_, cycle);
}

std::vector<ForceBin> fewerBins(std::span<const ForceBin> bins, std::size_t most) {
  const std::size_t together = (bins.size() + most - 1) / std::max<std::size_t>(most, 1);
  std::vector<ForceBin> fewer;
  for (std::size_t i = 0; i < bins.size(); ++i) {
    if (i % together == 0)
      fewer.push_back(bins[i]);
    else
      extend(fewer.back(), bins[i]);
  }
  return fewer;
}

Json forceJson(std::span<const ForceBin> bins, int first_module, int modules, double zero_s) {
  Json t = Json::array(), low = Json::array(), high = Json::array();
  for (const ForceBin& bin : bins) t.push_back(rounded(bin.from_s - zero_s));
  for (int i = first_module; i < first_module + modules; ++i) {
    Json least = Json::array(), most = Json::array();
    for (const ForceBin& bin : bins) {
      least.push_back(rounded(bin.least_N[i]));
      most.push_back(rounded(bin.most_N[i]));
    }
    low.push_back(std::move(least));
    high.push_back(std::move(most));
  }
  return {{"t", std::move(t)}, {"low", std::move(low)}, {"high", std::move(high)}};
}

}  // namespace tactus
