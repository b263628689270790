#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "campaign/exhaustive.h"
#include "campaign/run.h"
#include "campaign/self_test.h"
#include "campaign/share.h"

/// Tries to break "rest is rest": troubles by chance, alone and together, and what must hold in
/// every cycle of stopping and going on.
namespace tactus::campaign {
namespace {

struct Options {
  std::uint64_t seed = 1;
  int runs = 1000;
  int jobs = 1;
  std::optional<int> only;  ///< this run, with a trace
  bool is_self_test = false;
  bool is_list = false;
  bool is_exhaustive = false;
  ExhaustiveOptions all;
};

std::optional<Options> parse(int count, char** arguments) {
  Options options;
  for (int i = 1; i < count; ++i) {
    const std::string_view key = arguments[i];
    if (key == "--self-test") {
      options.is_self_test = true;
      continue;
    }
    if (key == "--list") {
      options.is_list = true;
      continue;
    }
    if (i + 1 == count) return std::nullopt;
    if (key == "--all" || key == "--case") {
      options.is_exhaustive = true;
      (key == "--all" ? options.all.results : options.all.only.emplace()) = arguments[++i];
      continue;
    }
    char* end = nullptr;
    const long value = std::strtol(arguments[++i], &end, 10);
    if (*end != 0 || value < 0) return std::nullopt;
    if (key == "--seed")
      options.seed = static_cast<std::uint64_t>(value);
    else if (key == "--runs")
      options.runs = static_cast<int>(value);
    else if (key == "--jobs")
      options.all.jobs = options.jobs = std::max(1, static_cast<int>(value));
    else if (key == "--first")
      options.all.first = static_cast<int>(value);
    else if (key == "--run")
      options.only = static_cast<int>(value);
    else
      return std::nullopt;
  }
  return options;
}

int runOne(const Options& options) {
  const Plan plan = drawPlan(options.seed, static_cast<std::uint64_t>(*options.only),
                             campaignScene(kVariants[0]));
  fmt::print("{}\n", plan.text());
  const Result result = simulate(bootStage(kVariants[plan.variant]), plan, true);
  for (const Violation& violation : result.violations)
    fmt::print("{:6} ms  VIOLATION {}: {} {}\n", violation.t_ms, violation.judge, violation.what,
               violation.detail);
  return result.violations.empty() ? 0 : 1;
}

/// The same words for the same defect.
std::string className(const Violation& violation) {
  return fmt::format("{}: {}", violation.judge, violation.what);
}

struct Found {
  int run;
  const Violation* violation;
};

void report(const Options& options, const std::vector<Plan>& plans,
            const std::vector<Result>& results) {
  std::map<std::string, std::vector<Found>> classes;
  std::map<std::string, int> ends;
  for (int run = 0; run < options.runs; ++run) {
    for (const Violation& violation : results[run].violations)
      classes[className(violation)].push_back({run, &violation});
    ++ends[fmt::format("{} ({})", modeName(results[run].mode), faultName(results[run].fault))];
  }
  for (const auto& [name, all] : classes) {
    fmt::print("\n{}  in {} runs\n", name, all.size());
    for (const Found& one : all)
      fmt::print("  tools/campaign --seed {} --run {}  # {} at {} ms; {}\n", options.seed, one.run,
                 one.violation->detail, one.violation->t_ms, plans[one.run].text());
  }
  fmt::print("\nlargest joint speed in the 3 s after going on, all over but for hands\n");
  for (std::size_t variant = 0; variant < kVariants.size(); ++variant) {
    double peak = 0.0;
    for (int run = 0; run < options.runs; ++run)
      if (plans[run].variant == static_cast<int>(variant)) peak = std::max(peak, results[run].peak);
    fmt::print("  {:5.2f}  {}\n", peak, kVariants[variant]);
  }
  fmt::print("\nended\n");
  for (const auto& [name, count] : ends) fmt::print("  {:5}  {}\n", count, name);
  for (const auto& [name, all] : classes)
    fmt::print("VIOLATED in {:5} runs  {}\n", all.size(), name);
}

int runAll(const Options& options) {
  const auto start = std::chrono::steady_clock::now();
  std::vector<std::optional<Stage>> stages(kVariants.size());
  share(options.jobs, static_cast<int>(kVariants.size()),
        [&](int i) { stages[i].emplace(bootStage(kVariants[i])); });
  std::vector<Plan> plans(options.runs);
  std::vector<Result> results(options.runs);
  share(options.jobs, options.runs, [&](int i) {
    plans[i] = drawPlan(options.seed, static_cast<std::uint64_t>(i), stages[0]->scene);
    results[i] = simulate(*stages[plans[i].variant], plans[i], false);
  });
  report(options, plans, results);
  long long cycles = 0, bad = 0;
  for (const Result& result : results) {
    cycles += result.cycles;
    bad += result.violations.empty() ? 0 : 1;
  }
  const double duration_s =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  fmt::print(
      "{} runs, {} with violations; {:.1f} million cycles in {:.0f} s, {:.0f} a second and job\n",
      options.runs, bad, 1e-6 * static_cast<double>(cycles), duration_s,
      static_cast<double>(cycles) / duration_s / options.jobs);
  return bad == 0 ? 0 : 1;
}

}  // namespace
}  // namespace tactus::campaign

int main(int count, char** arguments) {
  using namespace tactus::campaign;
  const auto options = parse(count, arguments);
  if (!options) {
    std::fputs(
        "usage: tactus_campaign [--seed S] [--runs N] [--jobs N]   a campaign\n"
        "       tactus_campaign [--seed S] --run I                 one run of it, with what "
        "happens\n"
        "       tactus_campaign --all FILE [--first N] [--jobs N]  every case, or the first N, "
        "into "
        "FILE\n"
        "       tactus_campaign --case NAME                        one of them, with what happens\n"
        "       tactus_campaign --list                             their names\n"
        "       tactus_campaign --self-test                        that every judge sees its "
        "harm\n",
        stderr);
    return 2;
  }
  if (options->is_self_test) return selfTest();
  if (options->is_list) return listCases();
  if (options->is_exhaustive) return runExhaustive(options->all);
  return options->only ? runOne(*options) : runAll(*options);
}
