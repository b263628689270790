#include <fmt/format.h>
#include <malloc.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "soak/growth.h"
#include "soak/resources.h"
#include "soak/self_test.h"
#include "soak/soak.h"

/// A daemon in virtual time for days, with troubles, requests, restarts and losses of power by
/// chance: does it stay as it is?
namespace tactus::soak {
namespace {

volatile std::sig_atomic_t is_interrupted = 0;

constexpr double kMostHeapGrowth_bytes = 1e6;      ///< at the starts of lives
constexpr double kMostResidentGrowth_bytes = 8e6;  ///< likewise
/// Within a life: what ContactList keeps of a contact that lasts for 17 minutes, and the summary of
/// ten thousand contacts (kMostContacts).
constexpr double kMostHeapGrowthOfALife_bytes = 16.8e6 + 5e6;
constexpr std::size_t kLeastLives = 8;   ///< to tell growth from start to start
constexpr int kLogFiles = 4;             ///< run.ulg and log.keep of the scene
constexpr double kMostLog_bytes = 12e7;  ///< log.max_bytes of each
/// Of eight clients at most, and of what a request or a rotation opens for a moment.
constexpr int kDescriptorsOfClients = 10;

struct Options {
  double hours = 72.0;
  std::uint64_t seed = 1;
  std::string folder = "build/soak";
  std::optional<int> only;  ///< this life
};

std::optional<Options> parse(int count, char** arguments) {
  Options options;
  for (int i = 1; i + 1 < count; i += 2) {
    const std::string_view key = arguments[i];
    char* end = arguments[i + 1];
    if (key == "--hours")
      options.hours = std::strtod(arguments[i + 1], &end);
    else if (key == "--seed")
      options.seed = std::strtoull(arguments[i + 1], &end, 10);
    else if (key == "--life")
      options.only = static_cast<int>(std::strtol(arguments[i + 1], &end, 10));
    else if (key == "-o")
      options.folder = std::exchange(end, nullptr);
    else
      return std::nullopt;
    if (end && (end == arguments[i + 1] || *end != 0)) return std::nullopt;
  }
  const bool is_valid = options.hours > 0.0 && options.hours <= 1e4 && count % 2 == 1;
  return is_valid ? std::optional(options) : std::nullopt;
}

/// How it went, minute by minute.
class Course {
 public:
  Course(const std::string& folder, double report_s) : folder_(folder), report_s_(report_s) {}

  /// As a life begins. What the one before has given back, the allocator may keep: a process of its
  /// own would begin without.
  void begin(const Tally& tally) {
    malloc_trim(0);
    note();
    heap_.push_back({tally.t_s, now_.heap_bytes});
    resident_.push_back({tally.t_s, now_.resident_bytes});
    heap_at_start_bytes_ = now_.heap_bytes;
  }

  /// Within it.
  void look(const Tally& tally) {
    note();
    most_of_a_life_bytes_ = std::max(most_of_a_life_bytes_, now_.heap_bytes - heap_at_start_bytes_);
    if (tally.t_s < next_report_s_) return;
    next_report_s_ = tally.t_s + report_s_;
    fmt::print(
        "{:8.3f} h  {:6.1f} MB resident  {:6.2f} MB heap  {} descriptors  {} threads  {} logs  "
        "{:5.1f} MB  {} stops  {} going on  {} restarts  {} power cuts  {} requests  {} replayed\n",
        tally.t_s / 3600.0, 1e-6 * now_.resident_bytes, 1e-6 * now_.heap_bytes, now_.descriptors,
        now_.threads, now_.log_files, 1e-6 * now_.log_bytes, tally.stops, tally.goings_on,
        tally.lives - 1, tally.power_cuts, tally.requests.sent, tally.replays.cycles);
    std::fflush(stdout);
  }

  /// Returns whether nothing has grown.
  bool judge() const {
    fmt::print("descriptors {} to {}, threads {} to {}, at most {} logs of {:.1f} MB together\n",
               least_descriptors_, most_descriptors_, least_threads_, most_threads_,
               most_log_files_, 1e-6 * most_log_bytes_);
    const double heap = growth(heap_), resident = growth(resident_);
    fmt::print(
        "from start to start, last two thirds: heap {:+.3f} MB (limit {:.0f}), resident "
        "{:+.3f} MB (limit {:.0f}){}\n",
        1e-6 * heap, 1e-6 * kMostHeapGrowth_bytes, 1e-6 * resident,
        1e-6 * kMostResidentGrowth_bytes,
        heap_.size() < kLeastLives ? "; too few lives to judge" : "");
    fmt::print("heap within a life at most {:+.3f} MB (limit {:.1f})\n",
               1e-6 * most_of_a_life_bytes_, 1e-6 * kMostHeapGrowthOfALife_bytes);
    const bool has_memory_grown =
        heap_.size() >= kLeastLives &&
        (heap > kMostHeapGrowth_bytes || resident > kMostResidentGrowth_bytes);
    return !has_memory_grown && most_of_a_life_bytes_ <= kMostHeapGrowthOfALife_bytes &&
           most_descriptors_ <= least_descriptors_ + kDescriptorsOfClients &&
           most_threads_ == least_threads_ && most_log_files_ <= kLogFiles &&
           most_log_bytes_ <= kMostLog_bytes;
  }

 private:
  void note() {
    now_ = resourcesNow(folder_ + "/log");
    least_descriptors_ = std::min(least_descriptors_, now_.descriptors);
    most_descriptors_ = std::max(most_descriptors_, now_.descriptors);
    least_threads_ = std::min(least_threads_, now_.threads);
    most_threads_ = std::max(most_threads_, now_.threads);
    most_log_files_ = std::max(most_log_files_, now_.log_files);
    most_log_bytes_ = std::max(most_log_bytes_, now_.log_bytes);
  }

  std::string folder_;
  double report_s_, next_report_s_ = 0.0;
  Resources now_;
  std::vector<Reading> heap_, resident_;  ///< as lives begin
  double heap_at_start_bytes_ = 0.0, most_of_a_life_bytes_ = 0.0;
  int least_descriptors_ = 1 << 20, most_descriptors_ = 0;
  int least_threads_ = 1 << 20, most_threads_ = 0;
  int most_log_files_ = 0;
  double most_log_bytes_ = 0.0;
};

void printCounts(const char* name, const std::map<std::string, int>& counts) {
  fmt::print("{}:", name);
  for (const auto& [what, count] : counts) fmt::print(" {} {}", what, count);
  fmt::print("\n");
}

void print(const Tally& tally) {
  fmt::print(
      "{:.3f} h of virtual time, {} cycles and {} missed, {} lives, {} losses of power, {} "
      "starts where the arm was found\n",
      tally.t_s / 3600.0, tally.cycles, tally.missed_cycles, tally.lives, tally.power_cuts,
      tally.found);
  fmt::print("{} episodes with {} troubles, {} stops, {} holds, {} times to running\n",
             tally.episodes, tally.troubles, tally.stops, tally.holds, tally.goings_on);
  printCounts("faults", tally.faults);
  printCounts("brought home", tally.left);
  fmt::print("{} requests: {} changes of gains, {} targets and holds, {} refused\n",
             tally.requests.sent, tally.requests.gains, tally.requests.targets,
             tally.requests.refused);
  fmt::print("{} samples of {} logs: {} cycles replayed, {} of unknown state; {} samples unknown\n",
             tally.replays.samples, tally.replays.files, tally.replays.cycles,
             tally.replays.skipped, tally.replays.unknown);
  fmt::print("largest joint speed in the 3 s after going on: {:.3f} m/s or rad/s\n", tally.peak);
}

/// Returns whether all durations of all lives are in the histograms.
bool judgeHistograms(const Tally& tally) {
  bool is_right = true;
  for (std::size_t i = 0; i < tally.drawn.size(); ++i) {
    const auto cycles = static_cast<unsigned long long>(tally.cycles);
    is_right = is_right && tally.drawn[i].count() == cycles;
    for (const std::string& problem :
         tally.drawn[i].compare(Latencies::kNames[i], tally.histograms[i])) {
      fmt::print("VIOLATION {}\n", problem);
      is_right = false;
    }
  }
  fmt::print("histograms of {} cycles {}\n", tally.cycles, is_right ? "add up" : "DO NOT ADD UP");
  return is_right;
}

int soak(const Options& options) {
  std::filesystem::create_directories(options.folder + "/log");
  setenv("RUNTIME_DIRECTORY", options.folder.c_str(), 1);
  const double end_s = 3600.0 * options.hours;
  Tally tally;
  Course course(options.folder, std::max(60.0, end_s / 144.0));
  test::Random random(options.seed);
  const auto start = std::chrono::steady_clock::now();
  for (int number = 0; tally.t_s < end_s && is_interrupted == 0; ++number) {
    // The first one is long, without a restart.
    const double longest_s = std::max(60.0, std::min(14'400.0, end_s / 18.0));
    const double drawn_s = number == 0 ? end_s / 3.0 : random.logUniform(20.0, longest_s);
    if (options.only && *options.only != number) continue;
    if (!std::freopen((options.folder + "/journal").c_str(), "w", stderr)) return 1;
    std::setvbuf(stderr, nullptr, _IOLBF, 0);
    Life life(options.seed, number, options.folder, tally, [&] {
      course.look(tally);
      return is_interrupted == 0;
    });
    life.start();
    course.begin(tally);
    life.run(std::min(drawn_s, end_s - tally.t_s));
    life.end();
    if (options.only) break;
  }
  const double took_s =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  print(tally);
  const bool is_flat = course.judge();
  const bool is_counted = judgeHistograms(tally);
  fmt::print("{:.0f} s, {:.0f} times real time\n", took_s, tally.t_s / took_s);
  fmt::print("{} violations{}\n", tally.violations.size(), is_flat ? "" : "; NOT FLAT");
  return is_flat && is_counted && tally.violations.empty() ? 0 : 3;
}

}  // namespace
}  // namespace tactus::soak

int main(int count, char** arguments) {
  using namespace tactus::soak;
  if (count == 2 && std::string_view(arguments[1]) == "--self-test") return selfTest();
  const auto options = parse(count, arguments);
  if (!options) {
    std::fputs(
        "usage: tactus_soak [--hours H] [--seed S] [-o FOLDER] [--life NUMBER]\n"
        "       tactus_soak --self-test\n",
        stderr);
    return 2;
  }
  mallopt(M_ARENA_MAX, 1);  // what is handed out is told of the first alone
  std::signal(SIGINT, [](int) { is_interrupted = 1; });
  std::signal(SIGTERM, [](int) { is_interrupted = 1; });
  std::signal(SIGPIPE, SIG_IGN);
  return soak(*options);
}
