#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <string>

#include "tactus/cli/commands.h"
#include "tactus/cli/progress_line.h"
#include "tactus/record/csv_export.h"
#include "tactus/record/ulog_reader.h"
#include "tactus/scene/located_error.h"

namespace tactus {

void addExportCommand(CLI::App& app, int& exit_code) {
  struct ExportOptions {
    std::string log, output;
  };
  const auto options = std::make_shared<ExportOptions>();
  CLI::App* const command = app.add_subcommand("export", "Turn a log into CSV");
  command->add_option("log", options->log, "Log of a run (run.ulg)")->required();
  command->add_option("-o,--output", options->output, "CSV file to write, - for standard output")
      ->required();
  command->callback([options, &exit_code] {
    const LogExtent extent = checkLog(options->log);
    if (extent.cut_off) {
      fmt::print(stderr, "{}: the log was cut off after {} cycles\n", escaped(options->log),
                 extent.cycles);
    }
    ProgressLine line(options->output);
    exportCsv(options->log, options->output, [&](std::uint64_t cycles) {
      line.show(static_cast<double>(cycles) / static_cast<double>(extent.cycles));
    });
    exit_code = kExitDone;
  });
}

}  // namespace tactus
