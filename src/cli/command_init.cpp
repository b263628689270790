#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <system_error>
#include <vector>

#include "tactus/cli/commands.h"
#include "tactus/cli/robot_draft.h"
#include "tactus/record/run_error.h"
#include "tactus/scene/json.h"
#include "tactus/scene/located_error.h"

namespace tactus {
namespace {

struct InitOptions {
  std::string urdf, folder, tip;
  bool json = false;
};

/// All of them, or none; no file that is there is touched.
class NewFiles {
 public:
  explicit NewFiles(const std::vector<SourceFile>& files) {
    try {
      for (const SourceFile& file : files) write(file);
    } catch (...) {
      std::error_code ignored;  // the first one is told
      for (const std::string& path : written_) std::filesystem::remove(path, ignored);
      throw;
    }
  }

 private:
  void write(const SourceFile& file) {
    std::FILE* const out = std::fopen(file.path.c_str(), "wxe");
    if (!out) refuse(file.path);
    written_.push_back(file.path);
    const bool is_taken =
        std::fwrite(file.text.data(), 1, file.text.size(), out) == file.text.size();
    const bool is_closed = std::fclose(out) == 0;
    if (!is_taken || !is_closed)
      throw RunError(escaped(file.path) + ": cannot be written: " + std::strerror(errno));
  }

  [[noreturn]] static void refuse(const std::string& path) {
    const bool is_there = errno == EEXIST;
    failAt(beginOf(path), "-",
           is_there ? std::string("is there already")
                    : std::string("cannot be written: ") + std::strerror(errno),
           is_there ? "expected another folder: nothing is overwritten"
                    : "expected a folder that can be written");
  }

  std::vector<std::string> written_;
};

/// A folder with those that it lies in; those that were made are gone at the end unless kept.
class NewFolders {
 public:
  explicit NewFolders(const std::string& folder) {
    std::error_code error;
    std::filesystem::path missing = std::filesystem::absolute(folder, error).lexically_normal();
    for (; !missing.empty() && !std::filesystem::exists(missing, error) && !error;
         missing = missing.parent_path())
      missing_.push_back(missing);
    std::filesystem::create_directories(folder, error);
    if (!error) return;
    remove();
    failAt(beginOf(folder), "-", "cannot be made: " + error.message(), "expected a folder");
  }
  ~NewFolders() { remove(); }
  NewFolders(const NewFolders&) = delete;
  NewFolders& operator=(const NewFolders&) = delete;

  void keep() { missing_.clear(); }

 private:
  void remove() const noexcept {
    std::error_code ignored;  // of one that is not empty
    for (const auto& folder : missing_) std::filesystem::remove(folder, ignored);
  }

  std::vector<std::filesystem::path> missing_;  ///< the innermost first
};

Json jointsJson(const RobotDraft& draft) {
  Json joints = Json::array();
  for (std::size_t i = 0; i < draft.chain.joints.size(); ++i) {
    const auto j = static_cast<Eigen::Index>(i);
    const JointLimits& limits = draft.chain.limits;
    const bool is_prismatic = draft.chain.joints[i].type == JointType::kPrismatic;
    joints.push_back({{"name", draft.chain.joint_names[i]},
                      {"type", is_prismatic ? "prismatic" : "revolute"},
                      {"home", draft.home.q[j]},
                      {"lower", limits.lower[j]},
                      {"upper", limits.upper[j]},
                      {"max_velocity", limits.max_velocity[j]},
                      {"max_acceleration", draft.max_acceleration[i]},
                      {"max_effort", draft.chain.max_effort[j]},
                      {"mass_kg", draft.masses_kg.empty() ? Json() : Json(draft.masses_kg[i])}});
  }
  return joints;
}

Json draftJson(const RobotDraft& draft, const std::vector<SourceFile>& files) {
  Json written = Json::array(), assumed = Json::array(), unknown = Json::array();
  for (const SourceFile& file : files) written.push_back(file.path);
  for (const AssumedLimit& limit : draft.completed.assumed)
    assumed.push_back({{"joint", limit.joint}, {"limits", limit.what}});
  for (const UnknownPart& part : unknownParts())
    unknown.push_back({{"what", part.what}, {"how", part.how}});
  const Vector3& tool = draft.X_BaseTool.p_AB;
  return {{"written", written},
          {"robot", draft.chain.robot_name},
          {"tip", draft.tip},
          {"joints", jointsJson(draft)},
          {"task", draftTask(draft)},
          {"tool_home_m", {tool.x(), tool.y(), tool.z()}},
          {"smallest_singular_value_at_home", draft.home.smallest_singular_value},
          {"assumed_limits", assumed},
          {"warnings", draft.warnings},
          {"unknown", unknown}};
}

/// To be pasted into a shell.
std::string asWord(const std::string& path) {
  constexpr const char* kPlain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./+,:@%";
  const std::string shown = escaped(path);
  if (shown != path || shown.find_first_not_of(kPlain) == std::string::npos) return shown;
  std::string quoted = "'";
  for (const char c : shown) quoted += c == '\'' ? "'\\''" : std::string(1, c);
  return quoted + "'";
}

std::string draftSummary(const RobotDraft& draft, const std::vector<SourceFile>& files) {
  const Vector3& tool = draft.X_BaseTool.p_AB;
  std::string text;
  for (const SourceFile& file : files) text += fmt::format("written   {}\n", escaped(file.path));
  text += fmt::format("robot     {}, {} joints to {}\n", escaped(draft.chain.robot_name),
                      draft.chain.joints.size(), escaped(draft.tip));
  text +=
      fmt::format("home      tool at ({:.4f}, {:.4f}, {:.4f}) m, smallest singular value {:.3g}\n",
                  tool.x(), tool.y(), tool.z(), draft.home.smallest_singular_value);
  text += "assumed   accelerations: full speed within 0.2 s\n";
  if (draft.are_radii_assumed)
    text += "assumed   radii of collision_capsules: the URDF has no collision geometry; measure\n";
  for (const AssumedLimit& limit : draft.completed.assumed)
    text += fmt::format("assumed   {} of joint {}: the URDF has none; measure\n", limit.what,
                        escaped(limit.joint));
  for (const std::string& warning : draft.warnings)
    text += fmt::format("warning   {}\n", escaped(warning));
  for (const UnknownPart& part : unknownParts())
    text += fmt::format("unknown   {}: {}\n", part.what, part.how);
  const std::string scene = asWord(files.back().path);
  return text + fmt::format("next      tactus check {0}; tactus simulate {0} -o runs\n", scene);
}

void init(const InitOptions& options) {
  namespace fs = std::filesystem;
  if (options.folder.empty()) failAt(beginOf(""), "-o", "no folder", "expected a path");
  const fs::path folder = options.folder;
  const std::string robot = (folder / "robot.yaml").string(),
                    scene = (folder / "scene.yaml").string();
  const RobotDraft draft = draftRobot(options.urdf, options.folder, options.tip);
  std::vector<SourceFile> files;
  if (!draft.completed.text.empty())
    files.push_back({(folder / draft.urdf_reference).string(), draft.completed.text});
  files.push_back({robot, draft.robot_text});
  files.push_back({scene, draft.scene_text});
  NewFolders folders(options.folder);
  const NewFiles written(files);
  folders.keep();
  std::fputs(
      (options.json ? jsonText(draftJson(draft, files)) : draftSummary(draft, files)).c_str(),
      stdout);
}

}  // namespace

void addInitCommand(CLI::App& app, int& exit_code) {
  CLI::App* command =
      app.add_subcommand("init", "Begin a robot.yaml and a first scene from a URDF");
  const auto options = std::make_shared<InitOptions>();
  command->add_option("urdf", options->urdf, "Robot description")->required();
  command
      ->add_option("-o,--output", options->folder,
                   "Folder of robot.yaml and scene.yaml; nothing in it is overwritten")
      ->required();
  command->add_option("--tip", options->tip,
                      "Link that is the tool; by default the only one that nothing hangs on");
  command->add_flag("--json", options->json, "Print JSON");
  command->callback([options, &exit_code] {
    init(*options);
    exit_code = kExitDone;
  });
}

}  // namespace tactus
