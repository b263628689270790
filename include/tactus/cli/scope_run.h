#pragma once

#include <optional>
#include <string>

namespace tactus {

/// Of `tactus scope`.
struct ScopeOptions {
  std::string log;      ///< empty: that of the daemon that runs, which is followed
  std::string trigger;  ///< empty: force of any module above F_th
  std::string output;   ///< HTML; empty: none
  double pre_s = 0.3, post_s = 2.0;
  std::optional<double> hysteresis,
      holdoff_s;                            ///< absent: F_th - F_rel without a trigger, else 0; 0
  bool is_single = false, is_auto = false;  ///< one at most
  int keep = 5;
  bool follows = false, json = false;
};

/// Shows captures of a log on standard output, and writes the page. Throws InputError for a log, a
/// trigger or a page that is wrong, RunError where no daemon runs or the page cannot be written.
void runScope(ScopeOptions options);

}  // namespace tactus
