// What a production GPU compiler makes of the shader library, without that GPU: Mesa's RADV on its null
// device (RADV_FORCE_FAMILY), compute shaders, the driver's own statistics. Lower latency and inverse
// throughput are better; the driver assumes several iterations of each loop and multiplies those of nested
// ones, so that shaders with loops compare among themselves only.
#include <vulkan/vulkan.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "runtime/shader/shader_assembly.h"
#include "runtime/stream/shader_variants.h"
#include "shaders/loden_shared.h"
#include "tests/bench/bench_support.h"

namespace {

using namespace loden;
using namespace loden::runtime;
namespace fs = std::filesystem;

const char kEvaluate[] = R"(
#include "loden_shared.h"
#include "loden_interface.glsl"
#include "loden_directions.glsl"
#include "loden_vdim.glsl"
#include "loden_bands.glsl"
#include "loden_material.glsl"
layout(local_size_x = 64) in;
layout(set = 0, binding = 48) buffer Points { vec4 points[]; };
void main() {
  uint i = gl_GlobalInvocationID.x * 5u;
  vec3 wo = normalize(points[i].xyz), wi = normalize(points[i + 1u].xyz);
  LodenPoint m = loden_point_default();
#ifdef CURVED
  m.curvature = mat2(points[i + 3u].xy, points[i + 3u].zw);
  m.x_from_tangent = mat2(points[i + 4u].xy, points[i + 4u].zw);
#endif
  LodenHit h = loden_find_hit_at(m, points[i + 2u].xy, points[i + 2u].z, wo);
  points[i].xyz = loden_evaluate(h, wi, wo);
})";

const char kNormalMap[] = R"(
layout(set = 0, binding = 0) uniform sampler2D normal_map;
layout(set = 0, binding = 1) uniform sampler2D diffuse_map;
layout(local_size_x = 64) in;
layout(set = 0, binding = 48) buffer Points { vec4 points[]; };
void main() {
  uint i = gl_GlobalInvocationID.x * 3u;
  vec3 wi = normalize(points[i + 1u].xyz);
  vec3 n = normalize(textureLod(normal_map, points[i + 2u].xy, points[i + 2u].z).xyz);
  points[i].xyz = textureLod(diffuse_map, points[i + 2u].xy, points[i + 2u].z).xyz * max(dot(n, wi), 0.0);
})";

[[noreturn]] void stop(const char* what) {
  std::fprintf(stderr, "bench_radv: %s; skipped\n", what);
  std::exit(0);
}
void check(VkResult result, const char* what) {
  if (result != VK_SUCCESS) stop(what);
}

template <class T>
T made(VkStructureType type) {
  T value{};
  value.sType = type;
  return value;
}

std::vector<uint32_t> spirv(const char* text, std::vector<std::string> defines) {
  defines.push_back("LODEN_DESCRIPTOR_SET 0");
  const AssembledShader shader = bench::require(assembleShader("radv.comp", text, defines));
  const fs::path base = fs::temp_directory_path() / ("loden_radv_" + std::to_string(std::rand()));
  const fs::path source = base.string() + ".comp", binary = base.string() + ".spv";
  std::ofstream(source) << shader.text;
  const std::string command =
      "glslangValidator -V --quiet -o " + binary.string() + " " + source.string() + " >&2";
  if (std::system(command.c_str()) != 0) stop("glslangValidator did not take the shader");
  std::vector<uint32_t> words(fs::file_size(binary) / 4);
  std::ifstream(binary, std::ios::binary)
      .read(reinterpret_cast<char*>(words.data()), std::streamsize(words.size() * 4));
  fs::remove(source);
  fs::remove(binary);
  return words;
}

struct Gpu {
  VkInstance instance = nullptr;
  VkDevice device = nullptr;
  VkPipelineLayout layout = nullptr;
  std::string name;
};

VkPipelineLayout makeLayout(VkDevice device) {
  std::vector<VkDescriptorSetLayoutBinding> bindings;
  for (uint32_t unit = 0; unit < LODEN_MAX_UNITS;
       ++unit)  // from the weights on, those at which a variant's arrays begin
    bindings.push_back({unit, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
                        unit < LODEN_UNIT_WEIGHTS ? 1u : LODEN_MAX_BANDS, VK_SHADER_STAGE_COMPUTE_BIT,
                        nullptr});
  bindings.push_back({32, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr});
  bindings.push_back({48, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr});
  auto set_info = made<VkDescriptorSetLayoutCreateInfo>(VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO);
  set_info.bindingCount = uint32_t(bindings.size());
  set_info.pBindings = bindings.data();
  VkDescriptorSetLayout set = nullptr;
  check(vkCreateDescriptorSetLayout(device, &set_info, nullptr, &set), "no descriptor set layout");
  auto info = made<VkPipelineLayoutCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO);
  info.setLayoutCount = 1;
  info.pSetLayouts = &set;
  VkPipelineLayout layout = nullptr;
  check(vkCreatePipelineLayout(device, &info, nullptr, &layout), "no pipeline layout");
  return layout;
}

Gpu openGpu() {
  setenv("RADV_FORCE_FAMILY", "navi21", 0);
  setenv("VK_ICD_FILENAMES", "/usr/share/vulkan/icd.d/radeon_icd.x86_64.json", 0);
  Gpu gpu;
  auto app = made<VkApplicationInfo>(VK_STRUCTURE_TYPE_APPLICATION_INFO);
  app.apiVersion = VK_API_VERSION_1_2;
  auto instance_info = made<VkInstanceCreateInfo>(VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO);
  instance_info.pApplicationInfo = &app;
  check(vkCreateInstance(&instance_info, nullptr, &gpu.instance), "no Vulkan (package mesa-vulkan-drivers)");
  uint32_t count = 1;
  VkPhysicalDevice physical = nullptr;
  vkEnumeratePhysicalDevices(gpu.instance, &count, &physical);
  if (count == 0) stop("no RADV device");
  VkPhysicalDeviceProperties properties;
  vkGetPhysicalDeviceProperties(physical, &properties);
  gpu.name = properties.deviceName;
  const float priority = 1;
  auto queue = made<VkDeviceQueueCreateInfo>(VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO);
  queue.queueCount = 1;
  queue.pQueuePriorities = &priority;
  auto statistics = made<VkPhysicalDevicePipelineExecutablePropertiesFeaturesKHR>(
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PIPELINE_EXECUTABLE_PROPERTIES_FEATURES_KHR);
  statistics.pipelineExecutableInfo = VK_TRUE;
  VkPhysicalDeviceFeatures features{};
  features.shaderSampledImageArrayDynamicIndexing = VK_TRUE;
  features.shaderImageGatherExtended = VK_TRUE;
  const char* extension = VK_KHR_PIPELINE_EXECUTABLE_PROPERTIES_EXTENSION_NAME;
  auto info = made<VkDeviceCreateInfo>(VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO);
  info.pNext = &statistics;
  info.queueCreateInfoCount = 1;
  info.pQueueCreateInfos = &queue;
  info.enabledExtensionCount = 1;
  info.ppEnabledExtensionNames = &extension;
  info.pEnabledFeatures = &features;
  check(vkCreateDevice(physical, &info, nullptr, &gpu.device), "no device with pipeline statistics");
  gpu.layout = makeLayout(gpu.device);
  return gpu;
}

std::map<std::string, uint64_t> statisticsOf(const Gpu& gpu, const std::vector<uint32_t>& code) {
  auto module_info = made<VkShaderModuleCreateInfo>(VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO);
  module_info.codeSize = code.size() * 4;
  module_info.pCode = code.data();
  VkShaderModule module = nullptr;
  check(vkCreateShaderModule(gpu.device, &module_info, nullptr, &module), "no shader module");
  auto info = made<VkComputePipelineCreateInfo>(VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO);
  info.flags = VK_PIPELINE_CREATE_CAPTURE_STATISTICS_BIT_KHR;
  info.stage = {VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                nullptr,
                0,
                VK_SHADER_STAGE_COMPUTE_BIT,
                module,
                "main",
                nullptr};
  info.layout = gpu.layout;
  VkPipeline pipeline = nullptr;
  check(vkCreateComputePipelines(gpu.device, nullptr, 1, &info, nullptr, &pipeline), "no pipeline");
  const auto get = reinterpret_cast<PFN_vkGetPipelineExecutableStatisticsKHR>(
      vkGetDeviceProcAddr(gpu.device, "vkGetPipelineExecutableStatisticsKHR"));
  auto executable = made<VkPipelineExecutableInfoKHR>(VK_STRUCTURE_TYPE_PIPELINE_EXECUTABLE_INFO_KHR);
  executable.pipeline = pipeline;
  uint32_t count = 0;
  get(gpu.device, &executable, &count, nullptr);
  std::vector<VkPipelineExecutableStatisticKHR> found(
      count, made<VkPipelineExecutableStatisticKHR>(VK_STRUCTURE_TYPE_PIPELINE_EXECUTABLE_STATISTIC_KHR));
  get(gpu.device, &executable, &count, found.data());
  std::map<std::string, uint64_t> values;
  for (const VkPipelineExecutableStatisticKHR& statistic : found)
    values[statistic.name] = statistic.value.u64;
  vkDestroyPipeline(gpu.device, pipeline, nullptr);
  vkDestroyShaderModule(gpu.device, module, nullptr);
  return values;
}

void report(const Gpu& gpu, const std::string& name, const char* text,
            const std::vector<std::string>& defines) {
  std::map<std::string, uint64_t> s = statisticsOf(gpu, spirv(text, defines));
  const auto value = [&](const char* key) { return static_cast<unsigned long long>(s[key]); };
  std::printf("%-52s %12llu %8llu %8llu %10llu %10llu\n", name.c_str(), value("Instructions"), value("VGPRs"),
              value("Subgroups per SIMD"), value("Latency"), value("Inverse Throughput"));
}

}  // namespace

int main(int argc, char** argv) {
  bench::answerHelp(argc, argv, "bench_radv");
  const Gpu gpu = openGpu();
  std::printf("# bench_radv: %s, one point and one light per invocation\n", gpu.name.c_str());
  std::printf("%-52s %12s %8s %8s %10s %10s\n", "shader", "instructions", "VGPRs", "waves", "latency",
              "inv.thr.");
  report(gpu, "diffuse + normal map", kNormalMap, {});
  const MaterialVariant variants[] = {{true, 0, Lookup::kNone},
                                      {true, 0, Lookup::kPaper},
                                      {true, 0, Lookup::kFast},
                                      {true, 0, Lookup::kDefault},
                                      {true, 0, Lookup::kFast, Visibility::kFast},
                                      {true, 0, Lookup::kDefault, Visibility::kFast},
                                      {true, 1, Lookup::kFast, Visibility::kFast},
                                      {true, 1, Lookup::kDefault, Visibility::kFast},
                                      {false, 5, Lookup::kNone, Visibility::kNone, true},
                                      {false, 2, Lookup::kNone},
                                      {false, 2, Lookup::kFast},
                                      {false, 2, Lookup::kDefault},
                                      {true, 1, Lookup::kDefault, Visibility::kMap, false, 0, 2}};
  for (MaterialVariant variant : variants) {
    for (const bool height_field : {false, true}) {
      if (height_field && !hasRelief(variant)) continue;
      variant.height_field = height_field;
      std::vector<std::string> defines = variantDefines(variant);
      report(gpu, variantName(variant), kEvaluate, defines);
      if (!hasRelief(variant)) continue;
      defines.push_back("CURVED 1");
      defines.push_back("LODEN_FOLLOW_SURFACE 1");
      report(gpu, variantName(variant) + ", curved", kEvaluate, defines);
    }
  }
  return 0;
}
