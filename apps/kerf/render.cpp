// kerf render: a picture of what each pixel's ray hits.

#include <fmt/core.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/kerf/command.h"
#include "kerf/base/error.h"
#include "kerf/base/nearest_word.h"
#include "kerf/io/image_write.h"
#include "kerf/io/ply.h"
#include "kerf/render/views.h"
#include "kerf/scene/pipeline.h"

namespace kerf::app {
namespace {

using Json = nlohmann::ordered_json;

/// What the options were set to.
struct Arguments {
  std::string input, output, view = "normal", structure = BuildOptions{}.structure, size = "960x640", json;
  std::vector<double> eye, look_at, up;
  double fov = 45;
  int threads = 0;
  bool skip_invalid = false, quiet = false;
};

const ViewEntry& find_view(const std::string& name) {
  std::vector<std::string_view> names;
  for (const ViewEntry& entry : views()) {
    if (entry.name == name) return entry;
    names.push_back(entry.name);
  }
  throw Error(ErrorCode::invalid_option, "--view", fmt::format("unknown view '{}'{}", name, suggestion(name, names)));
}

std::array<uint32_t, 2> parse_size(const std::string& text) {
  std::array<uint32_t, 2> size{};
  char rest = 0;
  const bool is_plain = text.find_first_not_of("0123456789x") == std::string::npos && text.size() < 20;
  if (!is_plain || std::sscanf(text.c_str(), "%ux%u%c", &size[0], &size[1], &rest) != 2 || size[0] == 0 ||
      size[1] == 0 || size[0] > 65536 || size[1] > 65536) {
    throw Error(
        ErrorCode::invalid_option, "--size",
        fmt::format("'{}' is not a size; write it as WIDTHxHEIGHT, such as 960x640, each from 1 to 65536", text));
  }
  return size;
}

Vec3d vector_of(const std::vector<double>& v) { return {v[0], v[1], v[2]}; }

Camera make_camera(const Arguments& arguments, const Box3f& bounds, double aspect) {
  const Vec3d up = arguments.up.empty() ? Vec3d{0, 1, 0} : vector_of(arguments.up);
  if (!(arguments.fov > 0 && arguments.fov < 180)) {
    throw Error(ErrorCode::invalid_option, "--fov", "it must lie between 0 and 180 degrees");
  }
  Camera camera = framing_camera(bounds, aspect, up, arguments.fov);
  if (!arguments.look_at.empty()) camera.look_at = vector_of(arguments.look_at);
  if (!arguments.eye.empty()) camera.eye = vector_of(arguments.eye);
  return camera;
}

/// A bar with the time left on a terminal, nothing elsewhere; also where an interrupt is noticed.
class ProgressBar {
 public:
  explicit ProgressBar(bool quiet) : shown_(!quiet && isatty(STDERR_FILENO) != 0) {}
  ~ProgressBar() {
    if (drawn_) fmt::print(stderr, "\r{:60}\r", "");
  }

  bool operator()(double done) {
    const auto now = std::chrono::steady_clock::now();
    if (shown_ && now - last_ > std::chrono::milliseconds(100)) {
      const double spent = std::chrono::duration<double>(now - start_).count();
      const int full = static_cast<int>(done * 30);
      fmt::print(stderr, "\r[{:=<{}}{:{}}] {:3.0f} %, {:.1f} s left ", "", full, "", 30 - full, done * 100,
                 done > 0 ? spent / done - spent : 0);
      std::fflush(stderr);
      last_ = now;
      drawn_ = true;
    }
    return !interrupted();
  }

 private:
  bool shown_, drawn_ = false;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now(), last_ = start_;
};

Json number(double x) { return std::isfinite(x) ? Json(x) : Json("inf"); }

Json report_json(const BuildReport& r) {
  return {{"structure", r.structure},
          {"primitives", r.primitives},
          {"invalid", r.invalid},
          {"degenerate", r.degenerate},
          {"references", r.references},
          {"references_per_primitive", r.references_per_primitive},
          {"sa_max", number(r.sa_max)},
          {"capped", r.capped},
          {"bytes", r.bytes},
          {"nodes", r.nodes},
          {"leaves", r.leaves},
          {"depth", r.depth},
          {"sah_cost", r.sah_cost},
          {"tree_hash", fmt::format("{:016x}", r.tree_hash)},
          {"seconds",
           {{"references", r.seconds.references},
            {"split", r.seconds.split},
            {"build", r.seconds.build},
            {"layout", r.seconds.layout},
            {"total", r.seconds.total}}}};
}

Json result_json(const Arguments& arguments, const BuildReport& report, const ViewResult& result) {
  const double rays = result.rays > 0 ? static_cast<double>(result.rays) : 1;
  return {{"input", arguments.input},
          {"output", arguments.output},
          {"view", arguments.view},
          {"width", result.values.width},
          {"height", result.values.height},
          {"complete", result.complete},
          {"rays", result.rays},
          {"hits", result.hits},
          {"nodes_per_ray", static_cast<double>(result.counts.nodes) / rays},
          {"triangles_per_ray", static_cast<double>(result.counts.primitives) / rays},
          {"boxes_per_ray", static_cast<double>(result.counts.boxes) / rays},
          {"render_seconds", result.seconds},
          {"scene", report_json(report)}};
}

/// Finds mistakes in the words before any work is done: the structure, the output's format and folder.
void check_words(const Arguments& arguments) {
  parse_pipeline(arguments.structure);
  image_format(arguments.output);
  const std::filesystem::path folder = std::filesystem::path(arguments.output).parent_path();
  if (!folder.empty() && !std::filesystem::is_directory(folder)) {
    throw Error(ErrorCode::file, arguments.output, "there is no folder " + folder.string());
  }
}

int render(Arguments arguments) {
  if (arguments.output.empty()) {
    arguments.output = std::filesystem::path(arguments.input).filename().replace_extension(".png").string();
  }
  const ViewEntry& view = find_view(arguments.view);
  const auto [width, height] = parse_size(arguments.size);
  check_words(arguments);
  const Mesh mesh = read_ply(arguments.input);
  if (mesh.triangles.empty())
    throw Error(ErrorCode::file, arguments.input, "there is no face in it, so nothing to see");
  Scene scene;
  scene.add(TriangleMesh{std::span(mesh.vertices), std::span(mesh.triangles)});
  const BuildReport& report = scene.build({arguments.structure, arguments.threads, arguments.skip_invalid});
  if (report.capped && !arguments.quiet) {
    fmt::print(stderr, "kerf: note: the cap on references raised sa_max to {:.6g}\n", report.sa_max);
  }
  if (report.invalid > 0 && !arguments.quiet) {
    fmt::print(stderr, "kerf: note: {} invalid triangles were dropped\n", report.invalid);
  }
  const Camera camera = make_camera(arguments, scene.bounds(), static_cast<double>(width) / height);
  ViewResult result;
  {
    ProgressBar bar(arguments.quiet);
    watch_interrupts();
    result = render_view(scene, camera, {view.view, width, height, arguments.threads, std::ref(bar)});
  }
  const bool as_values = image_format(arguments.output) == ImageFormat::pfm;
  write_image(arguments.output, as_values ? result.values : displayed(view.view, result.values));
  if (!arguments.json.empty()) write_json(arguments.json, result_json(arguments, report, result).dump(2));
  if (!arguments.quiet) {
    fmt::print(stderr, "{} {} in {:.2f} s, built in {:.2f} s\n", arguments.output,
               result.complete ? "written" : "interrupted, written as far as it was", result.seconds,
               report.seconds.total);
  }
  return result.complete ? kDone : kInterrupted;
}

}  // namespace

void add_render(CLI::App& app, std::function<int()>& run) {
  CLI::App* command = app.add_subcommand("render", "Renders a view of a PLY model, one ray per pixel.");
  command->footer(
      "Example: kerf render sponza.ply -o depth.pfm --view depth --eye -12,3,0.5 --look-at 10,6,-0.5 --fov 60 \\\n"
      "             --structure 'early_split(budget=1.5)+binned_sah'");
  auto a = std::make_shared<Arguments>();
  command->add_option("input", a->input, "A PLY file")->required();
  command->add_option("-o,--output", a->output,
                      "Picture to write: .png to look at, .pfm for the values themselves "
                      "(default: the input's name with .png, in this folder)");
  command->add_option("--view", a->view, "depth, primitive, normal, uv, nodes or triangles; see kerf list")
      ->capture_default_str();
  command->add_option("--structure", a->structure, "How to find what rays hit; see kerf list")->capture_default_str();
  command->add_option("--size", a->size, "Width and height in pixels")->capture_default_str();
  command->add_option("--eye", a->eye, "Camera position X,Y,Z (default: the model is framed)")
      ->delimiter(',')
      ->expected(3);
  command->add_option("--look-at", a->look_at, "Point in the middle of the picture X,Y,Z")->delimiter(',')->expected(3);
  command->add_option("--up", a->up, "Direction that is up X,Y,Z (default: 0,1,0)")->delimiter(',')->expected(3);
  command->add_option("--fov", a->fov, "Vertical field of view in degrees")->capture_default_str();
  command->add_option("--threads", a->threads, "Threads to use; 0: all")
      ->check(CLI::Range(0, 4096))
      ->capture_default_str();
  command->add_flag("--skip-invalid", a->skip_invalid, "Drop triangles that are not finite, instead of an error");
  command->add_option("--json", a->json, "Write figures to this file; '-' is standard output");
  command->add_flag("--quiet", a->quiet, "No messages and no progress");
  command->callback([a, &run] { run = [a] { return render(*a); }; });
}

}  // namespace kerf::app
