#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdint>
#include <istream>
#include <memory>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

#include "tactus/cli/commands.h"
#include "tactus/daemon/named_file.h"
#include "tactus/daemon/number_within.h"
#include "tactus/daemon/running_log.h"
#include "tactus/io/datagram_socket.h"
#include "tactus/record/growing_file.h"
#include "tactus/record/run_error.h"
#include "tactus/record/ulog_reader.h"
#include "tactus/scene/located_error.h"

/// The run that goes on, to those who plot it.
namespace tactus {
namespace {

constexpr std::size_t kMaxDatagram = 1400;
constexpr const char* kPlotJuggler = "127.0.0.1:9870";

struct StreamOptions {
  std::string log;
  std::string to = kPlotJuggler;
  double rate_hz = 100.0;
};

/// As PlotJuggler's UDP server takes it: flat JSON objects with the time as `timestamp`; each other
/// member is a series, of that name behind a slash. What is not finite is left out, for JSON has no
/// word for it. A cycle takes several objects, as that server reads 2048 bytes of a datagram, and
/// networks carry 1500 in one piece.
void send(const CycleRecord& record, const std::vector<RecordColumn>& columns,
          const DatagramSocket& socket) {
  const std::string start = fmt::format("{{\"timestamp\":{}", record.t_s);
  std::string json = start;
  for (const RecordColumn& column : columns) {
    const double number = numberAt(record, column);
    if (!std::isfinite(number)) continue;
    const std::string member = fmt::format(",\"{}\":{}", column.name, number);
    if (json.size() + member.size() >= kMaxDatagram) {
      socket.send(json + "}");
      json = start;
    }
    json += member;
  }
  socket.send(json + "}");
}

/// Which cycles are sent, so that they are `rate_hz` in the mean, also where that is no whole part
/// of the cycles a second.
class StreamPace {
 public:
  explicit StreamPace(double rate_hz) : rate_hz_(rate_hz) {}

  /// Behind a gap it does not catch up.
  bool isDue(double t_s) {
    constexpr double kRounding_s = 1e-9;  // of the times of the log
    if (t_s < next_s() - kRounding_s) return false;
    ++sent_;
    if (t_s >= next_s()) {
      start_s_ = t_s;
      sent_ = 1;
    }
    return true;
  }

 private:
  double next_s() const { return start_s_ + static_cast<double>(sent_) / rate_hz_; }

  double rate_hz_, start_s_ = -kNoLimit;
  std::int64_t sent_ = 0;  ///< since start_s_
};

/// One file of the log; true: it goes on in another one. is_live: all is to be sent, also what the
/// next file holds already.
bool streamFile(const StreamOptions& options, const std::string& path, const DatagramSocket& socket,
                bool& is_live) {
  GrowingFile file(path);
  std::istream in(&file);
  UlogReader reader(in, path);
  const std::vector<RecordColumn> columns = recordColumns(reader.description().shape);
  CycleRecord record;
  StreamPace pace(options.rate_hz);
  while (reader.next(record)) {
    is_live = is_live || file.isLive();
    if (is_live && pace.isDue(record.t_s)) send(record, columns, socket);
  }
  is_live = is_live || file.isLive();
  return file.goesOn();
}

/// --plotjuggler may have no value, and the log come behind it.
void putInOrder(StreamOptions& options) {
  if (!options.log.empty() || !options.to.ends_with(".ulg")) return;
  options.log = options.to;
  options.to = kPlotJuggler;
}

int stream(StreamOptions options) {
  putInOrder(options);
  const std::string path = options.log.empty() ? runningLog() : options.log;
  try {
    const DatagramSocket socket(options.to);
    bool is_live = false;
    while (streamFile(options, path, socket, is_live)) {
    }
  } catch (const std::system_error& error) {
    throw RunError(fmt::format("{}: {}", escaped(options.to), error.code().message()));
  } catch (const std::invalid_argument& error) {
    throw InputError(fmt::format("--plotjuggler {}, expected HOST:PORT", escaped(error.what())));
  }
  return kExitDone;
}

}  // namespace

void addStreamCommand(CLI::App& app, int& exit_code) {
  const auto options = std::make_shared<StreamOptions>();
  CLI::App* const command =
      app.add_subcommand("stream", "Send the run that goes on to PlotJuggler");
  command->add_option("log", options->log, "Log of the run; else that of the daemon that runs")
      ->check(isNamed);
  command->add_option("--plotjuggler", options->to, "HOST:PORT of its UDP server")
      ->expected(0, 1)
      ->capture_default_str();
  command->add_option("--rate", options->rate_hz, "Cycles a second")
      ->check(numberWithin(0.1, 1000.0))
      ->capture_default_str();
  command->callback([options, &exit_code] { exit_code = stream(*options); });
}

}  // namespace tactus
