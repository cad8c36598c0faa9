// Occlusion-ray benchmark of Intel Embree 3, the yardstick for Umbrage.
//
//   apt-get install --no-install-recommends libembree-dev
//   g++ -O3 -march=native -std=c++17 occluded.cpp -lembree3 -pthread -o occluded
//   ./occluded DUMP [THREADS] [REPEATS] [--robust]
//
// DUMP, little endian: "UMBRAYS1", u64 triangles, u64 rays, triangles * 9 f32
// (corners), rays * 7 f32 (origin, unit direction, t_far), then a byte per ray:
// 1 where Umbrage found it blocked. Prints one JSON object.

#include <embree3/rtcore.h>
#include <immintrin.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <exception>
#include <fstream>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <type_traits>
#include <utility>
#include <vector>

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "the dump is read as it lies");

namespace {

constexpr size_t kBlock = 4096;  // a multiple of every packet and stream width
constexpr size_t kStream = 64;
constexpr unsigned kBuildThreads = 2;

struct DumpRay {
    float org[3], dir[3], t_far;
};
static_assert(sizeof(DumpRay) == 28);

struct Dump {
    std::vector<float> corners;
    std::vector<DumpRay> rays;
    std::vector<uint8_t> blocked;
};

struct Result {
    std::string mode;
    bool robust;
    double mrays_per_s;
    size_t blocked, differ;
};

using Device = std::unique_ptr<std::remove_pointer_t<RTCDevice>, decltype(&rtcReleaseDevice)>;
using Scene = std::unique_ptr<std::remove_pointer_t<RTCScene>, decltype(&rtcReleaseScene)>;

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// MXCSR is per thread: every thread that calls Embree has to set it.
void flush_denormals() {
    _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
    _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
}

Dump read_dump(const std::string& path) {
    std::ifstream in(path, std::ios::binary | std::ios::ate);
    if (!in) throw std::runtime_error(path + ": cannot open");
    const std::streamoff size = in.tellg();
    in.seekg(0);

    char magic[8];
    uint64_t counts[2];
    const auto read = [&](void* to, size_t bytes) {
        if (!in.read(static_cast<char*>(to), static_cast<std::streamsize>(bytes)))
            throw std::runtime_error(path + ": cannot read");
    };
    if (size < 24) throw std::runtime_error(path + ": too short for a header");
    read(magic, sizeof magic);
    read(counts, sizeof counts);
    const auto [triangles, rays] = counts;
    if (std::memcmp(magic, "UMBRAYS1", 8) != 0) throw std::runtime_error(path + ": not a ray dump");
    // Embree's vertex indices have 32 bits; the bound on rays keeps the sum below from wrapping.
    if (triangles == 0 || triangles > std::numeric_limits<uint32_t>::max() / 3)
        throw std::runtime_error(path + ": triangle count out of range");
    if (rays == 0 || rays > (uint64_t{1} << 40))
        throw std::runtime_error(path + ": ray count out of range");
    if (static_cast<uint64_t>(size) != 24 + triangles * 36 + rays * 29)
        throw std::runtime_error(path + ": size does not match its header");

    Dump dump;
    dump.corners.resize(triangles * 9);
    dump.rays.resize(rays);
    dump.blocked.resize(rays);
    read(dump.corners.data(), triangles * 36);
    read(dump.rays.data(), rays * 28);
    read(dump.blocked.data(), rays);
    return dump;
}

void check(RTCDevice device, const char* what) {
    if (const RTCError error = rtcGetDeviceError(device); error != RTC_ERROR_NONE)
        throw std::runtime_error(std::string(what) + ": Embree error " + std::to_string(error));
}

// The time of the commit alone: filling the buffers is the application's work.
std::pair<Scene, double> build(RTCDevice device, const Dump& dump, bool robust) {
    Scene scene(rtcNewScene(device), rtcReleaseScene);
    rtcSetSceneFlags(scene.get(), robust ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE);
    rtcSetSceneBuildQuality(scene.get(), RTC_BUILD_QUALITY_MEDIUM);

    // Shared vertices would not trace faster: Embree copies the corners into its leaves.
    const size_t triangles = dump.corners.size() / 9;
    RTCGeometry mesh = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    void* vertices = rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                             3 * sizeof(float), triangles * 3);
    void* indices = rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                            3 * sizeof(uint32_t), triangles);
    check(device, "geometry buffers");
    std::memcpy(vertices, dump.corners.data(), triangles * 36);
    for (size_t i = 0; i < triangles * 3; ++i) static_cast<uint32_t*>(indices)[i] = uint32_t(i);
    rtcCommitGeometry(mesh);
    rtcAttachGeometry(scene.get(), mesh);
    rtcReleaseGeometry(mesh);

    const auto start = std::chrono::steady_clock::now();
    rtcCommitScene(scene.get());
    const double took = seconds_since(start);
    check(device, "scene build");
    return {std::move(scene), took};
}

// One field of one ray, whether `Ray` is a single ray or a packet of N.
template <class T>
T& lane(T& field, size_t) { return field; }
template <class T, size_t N>
T& lane(T (&field)[N], size_t i) { return field[i]; }

template <class Ray>
void load(std::vector<Ray>& to, const std::vector<DumpRay>& from) {
    constexpr size_t width = sizeof(Ray) / sizeof(RTCRay);
    to.assign((from.size() + width - 1) / width, Ray{});
    for (size_t i = 0; i < from.size(); ++i) {
        Ray& ray = to[i / width];
        const size_t l = i % width;
        lane(ray.org_x, l) = from[i].org[0];
        lane(ray.org_y, l) = from[i].org[1];
        lane(ray.org_z, l) = from[i].org[2];
        lane(ray.dir_x, l) = from[i].dir[0];
        lane(ray.dir_y, l) = from[i].dir[1];
        lane(ray.dir_z, l) = from[i].dir[2];
        lane(ray.tfar, l) = from[i].t_far;
        lane(ray.mask, l) = ~0u;
    }
}

template <class Trace>
double time_trace(size_t rays, unsigned threads, const Trace& trace) {
    std::atomic<size_t> next{0};
    const auto work = [&] {
        flush_denormals();
        for (size_t begin; (begin = next.fetch_add(kBlock, std::memory_order_relaxed)) < rays;)
            trace(begin, std::min(begin + kBlock, rays));
    };
    std::vector<std::thread> pool;
    const auto start = std::chrono::steady_clock::now();
    for (unsigned i = 1; i < threads; ++i) pool.emplace_back(work);
    work();
    for (std::thread& thread : pool) thread.join();
    return seconds_since(start);
}

// `trace(rays, begin, end)` traces the rays with those indices. The rays lie in Embree's own
// layout before the clock starts, and are laid anew for each repeat, as a blocked ray's tfar
// is overwritten (with -inf, which is the answer).
template <class Ray, class Trace>
Result measure(const char* mode, bool robust, const Dump& dump, unsigned threads, unsigned repeats,
               const Trace& trace) {
    constexpr size_t width = sizeof(Ray) / sizeof(RTCRay);
    const size_t count = dump.rays.size();
    std::vector<Ray> rays;
    double best = std::numeric_limits<double>::infinity();
    for (unsigned r = 0; r < repeats; ++r) {
        load(rays, dump.rays);
        best = std::min(best, time_trace(count, threads, [&](size_t begin, size_t end) {
                            trace(rays.data(), begin, end);
                        }));
    }
    Result result{mode, robust, double(count) / best / 1e6, 0, 0};
    constexpr float kBlocked = -std::numeric_limits<float>::infinity();
    for (size_t i = 0; i < count; ++i) {
        const bool blocked = lane(rays[i / width].tfar, i % width) == kBlocked;
        result.blocked += blocked;
        result.differ += blocked != (dump.blocked[i] != 0);
    }
    return result;
}

RTCIntersectContext context(RTCIntersectContextFlags flags) {
    RTCIntersectContext c;
    rtcInitIntersectContext(&c);
    c.flags = flags;
    return c;
}

template <class Ray, class Occluded>
auto packets(RTCScene scene, Occluded occluded) {
    return [=](Ray* rays, size_t begin, size_t end) {
        constexpr size_t width = sizeof(Ray) / sizeof(RTCRay);
        auto c = context(RTC_INTERSECT_CONTEXT_FLAG_COHERENT);
        alignas(64) int valid[width];
        std::fill_n(valid, width, -1);
        for (size_t i = begin; i < end; i += width) {
            if (end - i < width) std::fill(valid + (end - i), valid + width, 0);
            occluded(valid, scene, &c, rays + i / width);
        }
    };
}

std::vector<Result> measure_modes(RTCDevice device, RTCScene scene, bool robust, const Dump& dump,
                                  unsigned threads, unsigned repeats) {
    const auto has = [&](RTCDeviceProperty p) { return rtcGetDeviceProperty(device, p) != 0; };
    std::vector<Result> results;
    results.push_back(measure<RTCRay>("occluded1", robust, dump, threads, repeats,
        [=](RTCRay* rays, size_t begin, size_t end) {
            auto c = context(RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT);
            for (size_t i = begin; i < end; ++i) rtcOccluded1(scene, &c, rays + i);
        }));
    if (has(RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED))
        results.push_back(measure<RTCRay8>("occluded8", robust, dump, threads, repeats,
                                           packets<RTCRay8>(scene, rtcOccluded8)));
    if (has(RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED))
        results.push_back(measure<RTCRay16>("occluded16", robust, dump, threads, repeats,
                                            packets<RTCRay16>(scene, rtcOccluded16)));
    if (has(RTC_DEVICE_PROPERTY_RAY_STREAM_SUPPORTED))
        results.push_back(measure<RTCRay>("occluded1M", robust, dump, threads, repeats,
            [=](RTCRay* rays, size_t begin, size_t end) {
                auto c = context(RTC_INTERSECT_CONTEXT_FLAG_COHERENT);
                for (size_t i = begin; i < end; i += kStream)
                    rtcOccluded1M(scene, &c, rays + i, unsigned(std::min(kStream, end - i)),
                                  sizeof(RTCRay));
            }));
    check(device, "tracing");
    return results;
}

// Embree does not tell its instruction set; the packet widths it calls native do.
const char* isa(RTCDevice device) {
    if (rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED)) return "avx512";
    if (rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED))
        return __builtin_cpu_supports("avx2") ? "avx2" : "avx";
    return "sse";
}

unsigned count_argument(const std::string& text, const char* name) {
    if (text.empty() || text.size() > 4 || text.find_first_not_of("0123456789") != text.npos ||
        std::stoul(text) == 0)
        throw std::runtime_error(std::string(name) + " must be from 1 to 9999, not '" + text + "'");
    return unsigned(std::stoul(text));
}

void run(int argc, char** argv) {
    std::vector<std::string> arguments;
    bool robust_only = false;
    for (int i = 1; i < argc; ++i) {
        if (std::strcmp(argv[i], "--robust") == 0) robust_only = true;
        else arguments.emplace_back(argv[i]);
    }
    if (arguments.empty() || arguments.size() > 3 || arguments[0].rfind("--", 0) == 0)
        throw std::runtime_error("usage: occluded DUMP [THREADS] [REPEATS] [--robust]");
    const unsigned threads = arguments.size() > 1
                                 ? count_argument(arguments[1], "THREADS")
                                 : std::max(1u, std::thread::hardware_concurrency());
    const unsigned repeats = arguments.size() > 2 ? count_argument(arguments[2], "REPEATS") : 3;

    flush_denormals();
    const Dump dump = read_dump(arguments[0]);
    const std::string config = "threads=" + std::to_string(kBuildThreads);
    const Device device(rtcNewDevice(config.c_str()), rtcReleaseDevice);
    check(device.get(), "device");

    std::vector<Result> results;
    std::string builds;
    double build_s = 0;
    for (const bool robust : {false, true}) {
        if (robust_only && !robust) continue;
        Scene scene(nullptr, rtcReleaseScene);
        double best = std::numeric_limits<double>::infinity();
        for (unsigned r = 0; r < repeats; ++r) {
            scene.reset();  // before the next build, so that there is never memory for two
            auto [built, took] = build(device.get(), dump, robust);
            scene = std::move(built);
            best = std::min(best, took);
        }
        char text[80];
        std::snprintf(text, sizeof text, "%s{\"robust\":%s,\"build_s\":%.4f}",
                      builds.empty() ? "" : ",", robust ? "true" : "false", best);
        if (builds.empty()) build_s = best;
        builds += text;
        for (Result& r : measure_modes(device.get(), scene.get(), robust, dump, threads, repeats))
            results.push_back(std::move(r));
    }

    const long version = long(rtcGetDeviceProperty(device.get(), RTC_DEVICE_PROPERTY_VERSION));
    std::printf("{\"embree\":\"%ld.%ld.%ld\",\"isa\":\"%s\",\"triangles\":%zu,\"rays\":%zu,"
                "\"threads\":%u,\"build_threads\":%u,\"build_s\":%.4f,\"builds\":[%s],\"modes\":[",
                version / 10000, version / 100 % 100, version % 100, isa(device.get()),
                dump.corners.size() / 9, dump.rays.size(), threads, kBuildThreads, build_s,
                builds.c_str());
    const Result* verdict = nullptr;  // the careful answers: robust, one ray at a time
    for (const Result& r : results) {
        std::printf("%s{\"mode\":\"%s\",\"robust\":%s,\"mrays_per_s\":%.3f,\"differ\":%zu}",
                    &r == &results.front() ? "" : ",", r.mode.c_str(), r.robust ? "true" : "false",
                    r.mrays_per_s, r.differ);
        if (r.robust && r.mode == "occluded1") verdict = &r;
    }
    std::printf("],\"blocked\":%zu,\"differ\":%zu}\n", verdict->blocked, verdict->differ);
}

}  // namespace

int main(int argc, char** argv) {
    try {
        run(argc, argv);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "occluded: %s\n", error.what());
        return 1;
    }
}
