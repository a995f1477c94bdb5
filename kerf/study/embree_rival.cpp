#include "kerf/study/embree_rival.h"

#include <fmt/format.h>

#include <array>
#include <atomic>
#include <chrono>
#include <iostream>
#include <sstream>
#include <utility>

#include "kerf/base/error.h"
#include "kerf/render/camera.h"
#include "kerf/study/embree_calls.h"
#include "kerf/study/embree_pass.h"
#include "kerf/study/embree_text.h"

namespace kerf {
namespace {

struct Quality {
  const char* name;
  RTCBuildQuality quality;
  RTCSceneFlags flags;
};
constexpr Quality kQualities[] = {{"low", RTC_BUILD_QUALITY_LOW, RTC_SCENE_FLAG_NONE},
                                  {"medium", RTC_BUILD_QUALITY_MEDIUM, RTC_SCENE_FLAG_NONE},
                                  {"high", RTC_BUILD_QUALITY_HIGH, RTC_SCENE_FLAG_NONE},
                                  {"robust", RTC_BUILD_QUALITY_HIGH, RTC_SCENE_FLAG_ROBUST}};

constexpr const char* kOptions = "hugepages=1,start_threads=1";

[[noreturn]] void refuse(const std::string& sentence) { throw Error(ErrorCode::invalid_option, "embree", sentence); }

/// What Embree writes to std::cout while one lives; what it writes to std::cerr is lost, for its error codes say it
/// too.
class CapturedOutput {
 public:
  CapturedOutput() : output_(std::cout.rdbuf(text_.rdbuf())), errors_(std::cerr.rdbuf(lost_.rdbuf())) {}
  ~CapturedOutput() {
    std::cout.rdbuf(output_);
    std::cerr.rdbuf(errors_);
  }
  CapturedOutput(const CapturedOutput&) = delete;
  CapturedOutput& operator=(const CapturedOutput&) = delete;
  std::string text() const { return text_.str(); }

 private:
  std::ostringstream text_, lost_;
  std::streambuf *output_, *errors_;
};

/// A device, and the memory that it holds.
class Device {
 public:
  Device(int threads, const char* more)
      : device_(rtcNewDevice(fmt::format("threads={},{}{}", threads, kOptions, more).c_str())) {
    if (device_ == nullptr)
      refuse(fmt::format("it does not start, error {}", static_cast<int>(rtcGetDeviceError(nullptr))));
  }
  ~Device() { rtcReleaseDevice(device_); }
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  RTCDevice get() const { return device_; }

  /// From now on its bytes are counted; what would pass the limit is refused.
  void watch_memory(size_t limit) {
    limit_ = limit;
    rtcSetDeviceMemoryMonitorFunction(device_, watch, this);
  }
  size_t bytes() const { return static_cast<size_t>(std::max<std::ptrdiff_t>(bytes_, 0)); }

 private:
  static bool watch(void* data, ssize_t bytes, bool) {
    auto& device = *static_cast<Device*>(data);
    const std::ptrdiff_t now = device.bytes_ += bytes;
    return bytes < 0 || now < 0 || static_cast<size_t>(now) <= device.limit_;
  }

  RTCDevice device_;
  std::atomic<std::ptrdiff_t> bytes_ = 0;
  size_t limit_ = 0;
};

/// The shapes of a scene in arrays that Embree can share.
class SharedArrays {
 public:
  explicit SharedArrays(const SceneDescription& scene) : scene_(scene) {
    for (const SceneObject& object : scene.objects) {
      std::vector<float> numbers;
      if (const auto* mesh = std::get_if<Mesh>(&object.shape)) {
        for (const Vec3f& v : mesh->vertices) numbers.insert(numbers.end(), {v.x, v.y, v.z});
      } else if (const auto* sphere = std::get_if<Sphere>(&object.shape)) {
        numbers = {sphere->center.x, sphere->center.y, sphere->center.z, sphere->radius};
      } else {
        for (const Vec3d& p : std::get<Parallelogram>(object.shape).corners()) {
          for (uint32_t axis = 0; axis < 3; ++axis) numbers.push_back(static_cast<float>(p[axis]));
        }
      }
      numbers.push_back(0);  // Embree loads four numbers where three are meant
      numbers_.push_back(std::move(numbers));
    }
  }

  /// Adds all of them to a scene of Embree's.
  void add_to(RTCScene scene, RTCDevice device) const {
    for (size_t i = 0; i < numbers_.size(); ++i) {
      const RTCGeometry geometry = make(scene_.objects[i], numbers_[i].data(), device);
      rtcSetGeometryMask(geometry, scene_.objects[i].visible ? ~0U : ~kCameraMask);
      rtcCommitGeometry(geometry);
      rtcAttachGeometryByID(scene, geometry, static_cast<unsigned int>(i));
      rtcReleaseGeometry(geometry);
    }
  }

  bool has_hidden() const {
    return std::any_of(scene_.objects.begin(), scene_.objects.end(), [](const auto& o) { return !o.visible; });
  }

 private:
  static RTCGeometry make(const SceneObject& object, const float* numbers, RTCDevice device) {
    static constexpr std::array<uint32_t, 4> kAround = {0, 1, 2, 3};
    const auto share = [](RTCGeometry to, RTCBufferType type, RTCFormat format, const void* from, size_t stride,
                          size_t count) { rtcSetSharedGeometryBuffer(to, type, 0, format, from, 0, stride, count); };
    if (const auto* mesh = std::get_if<Mesh>(&object.shape)) {
      const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
      share(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, numbers, sizeof(Vec3f), mesh->vertices.size());
      share(geometry, RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3, mesh->triangles.data(), sizeof(Mesh::Corners),
            mesh->triangles.size());
      return geometry;
    }
    if (std::holds_alternative<Sphere>(object.shape)) {
      const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_SPHERE_POINT);
      share(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT4, numbers, sizeof(Sphere), 1);
      return geometry;
    }
    const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_QUAD);
    share(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, numbers, sizeof(Vec3f), kAround.size());
    share(geometry, RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT4, kAround.data(), sizeof(kAround), 1);
    return geometry;
  }

  const SceneDescription& scene_;
  std::vector<std::vector<float>> numbers_;  // of each object
};

/// A scene of Embree's.
class Built {
 public:
  /// Takes the seconds of rtcCommitScene() alone.
  Built(const SharedArrays& arrays, RTCDevice device, const Quality& quality, const WorkLimit& limit)
      : scene_(rtcNewScene(device)) {
    rtcSetSceneBuildQuality(scene_, quality.quality);
    rtcSetSceneFlags(scene_, quality.flags);
    rtcSetSceneProgressMonitorFunction(scene_, is_wanted, const_cast<WorkLimit*>(&limit));
    arrays.add_to(scene_, device);
    const FlushedDenormals flushed;
    const auto start = std::chrono::steady_clock::now();
    rtcCommitScene(scene_);
    seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    rtcSetSceneProgressMonitorFunction(scene_, nullptr, nullptr);
    const RTCError error = rtcGetDeviceError(device);
    if (error == RTC_ERROR_NONE) return;
    rtcReleaseScene(scene_);
    limit.check();
    throw Error(ErrorCode::stopped, "embree",
                error == RTC_ERROR_OUT_OF_MEMORY ? "it needs more memory than it may have"
                                                 : fmt::format("it did not build, error {}", static_cast<int>(error)));
  }
  ~Built() { rtcReleaseScene(scene_); }
  Built(const Built&) = delete;
  Built& operator=(const Built&) = delete;

  RTCScene scene() const { return scene_; }
  double seconds() const { return seconds_; }

 private:
  static bool is_wanted(void* data, double) {
    try {
      static_cast<const WorkLimit*>(data)->check();
      return true;
    } catch (const Error&) {
      return false;
    }
  }

  RTCScene scene_;
  double seconds_ = 0;
};

/// What all qualities share.
struct Shared {
  SharedArrays arrays;
  int threads;
  Device device;

  Shared(const SceneDescription& scene, int count) : arrays(scene), threads(count), device(count, "") {}
};

class EmbreeSubject : public BenchSubject {
 public:
  EmbreeSubject(std::shared_ptr<Shared> shared, const Quality& quality)
      : shared_(std::move(shared)), quality_(quality) {
    row_.engine = BenchEngine::embree;
    row_.quality = quality.name;
  }

  BenchRow describe() const override { return row_; }

  BenchRow build(const WorkLimit& limit) override {
    describe_build(limit);
    built_ = std::make_unique<Built>(shared_->arrays, shared_->device.get(), quality_, limit);
    row_.finished = true;
    row_.why_not.clear();
    row_.builds = {built_->seconds()};
    return row_;
  }

  double time_build(const WorkLimit& limit) const override {
    return Built(shared_->arrays, shared_->device.get(), quality_, limit).seconds();
  }

  /// All ways for the quality that is the mark.
  std::vector<Feed> feeds() const override {
    if (quality_.quality != RTC_BUILD_QUALITY_HIGH || quality_.flags != RTC_SCENE_FLAG_NONE) return {Feed::loop};
    std::vector<Feed> all{Feed::loop, Feed::sorted};
    const auto has = [&](RTCDeviceProperty p) { return rtcGetDeviceProperty(shared_->device.get(), p) != 0; };
    if (has(RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED)) all.push_back(Feed::packets_8);
    if (has(RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED)) all.push_back(Feed::packets_16);
    if (kHasStreams) all.push_back(Feed::stream);
    return all;
  }

  std::unique_ptr<BenchPass> prepare(const RaysToTrace& rays, Feed feed) const override {
    return embree_pass(built_->scene(), rays, feed);
  }

 private:
  /// A build on a device that tells of itself, not timed.
  void describe_build(const WorkLimit& limit) {
    const CapturedOutput output;
    Device device(shared_->threads, ",verbose=2");
    device.watch_memory(limit.bytes);
    const Built built(shared_->arrays, device.get(), quality_, limit);
    row_.bytes = device.bytes();
    const EmbreeText text = parse_embree_text(output.text());
    row_.builder = text.builder;
    row_.layout = text.layout;
    row_.isa = text.isa;
    row_.references = text.references;
  }

  std::shared_ptr<Shared> shared_;
  const Quality& quality_;
  BenchRow row_;
  std::unique_ptr<Built> built_;
};

std::string settings_of(int threads) {
  EmbreeText text;
  {
    const CapturedOutput output;
    const Device device(threads, ",verbose=2");
    text = parse_embree_text(output.text());
  }
  return fmt::format(
      "Embree {} (API {}.{}.{}); device: threads={},{}; huge pages: {}; FTZ and DAZ: on in its builds and timed loops\n"
      "vertex and index buffers shared; scene flags: none, robust: RTC_SCENE_FLAG_ROBUST; rays: coherent for primary, "
      "else incoherent",
      text.version.empty() ? "of unknown version" : text.version, RTC_VERSION_MAJOR, RTC_VERSION_MINOR,
      RTC_VERSION_PATCH, threads, kOptions, text.hugepages.empty() ? "unknown" : text.hugepages);
}

}  // namespace

EmbreeRival embree_rival(const SceneDescription& scene, int threads) {
  EmbreeRival rival;
  rival.settings = settings_of(threads);
  const auto shared = std::make_shared<Shared>(scene, threads);
  if (shared->arrays.has_hidden() &&
      rtcGetDeviceProperty(shared->device.get(), RTC_DEVICE_PROPERTY_RAY_MASK_SUPPORTED) == 0) {
    refuse("some objects are hidden from the camera, and this Embree was built without ray masks");
  }
  for (const Quality& quality : kQualities) rival.subjects.push_back(std::make_unique<EmbreeSubject>(shared, quality));
  return rival;
}

}  // namespace kerf
