#include "gpu/context/context.h"

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <cstring>
#include <stdexcept>
#include <string_view>

#include "gpu/context/driver_threads.h"
#include "gpu/context/fused_fma.h"
#include "gpu/shaders/layout.h"

namespace osteon::gpu {
namespace {

constexpr const char* kNoDriver =
    "no Vulkan driver found; install one (mesa-vulkan-drivers has lavapipe, which needs no GPU)";

std::string Lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

// Rank of a kind of device in the order of preference: 0 (preferred) … 4.
int Rank(vk::PhysicalDeviceType type) {
  switch (type) {
    case vk::PhysicalDeviceType::eDiscreteGpu:
      return 0;
    case vk::PhysicalDeviceType::eIntegratedGpu:
      return 1;
    case vk::PhysicalDeviceType::eVirtualGpu:
      return 2;
    case vk::PhysicalDeviceType::eCpu:
      return 3;
    default:
      return 4;
  }
}

// Index of the queue family to use, preferably one for compute without graphics; absent: the device has no
// compute queue.
std::optional<std::uint32_t> ComputeFamily(const vk::raii::PhysicalDevice& device) {
  const auto families = device.getQueueFamilyProperties();
  // a submit to a family without graphics takes half the time
  std::optional<std::uint32_t> found;
  for (std::uint32_t i = 0; i < families.size(); ++i) {
    const vk::QueueFlags flags = families[i].queueFlags;
    if (!(flags & vk::QueueFlagBits::eCompute)) continue;
    if (!(flags & vk::QueueFlagBits::eGraphics)) return i;
    if (!found) found = i;
  }
  return found;
}

// Describes a device for the user, including the needs that it does not meet.
DeviceInfo Inspect(const vk::raii::PhysicalDevice& device) {
  const auto chain =
      device.getProperties2<vk::PhysicalDeviceProperties2, vk::PhysicalDeviceDriverProperties>();
  const vk::PhysicalDeviceProperties& p = chain.get<vk::PhysicalDeviceProperties2>().properties;
  const auto& driver = chain.get<vk::PhysicalDeviceDriverProperties>();
  // indexed by Rank
  static constexpr const char* kKinds[] = {"discrete", "integrated", "virtual", "cpu", "other"};
  DeviceInfo info{.name = p.deviceName.data(),
                  .kind = kKinds[Rank(p.deviceType)],
                  .api_version = ApiVersionText(p.apiVersion),
                  .driver = std::string(driver.driverName.data()) + " " + driver.driverInfo.data(),
                  .refusal = ""};
  const auto memory = device.getMemoryProperties();
  for (std::uint32_t i = 0; i < memory.memoryHeapCount; ++i)
    if (memory.memoryHeaps[i].flags & vk::MemoryHeapFlagBits::eDeviceLocal)
      info.memory_bytes = std::max(info.memory_bytes, static_cast<double>(memory.memoryHeaps[i].size));
  const DeviceReport report = ReportOf(device);
  info.unmet = UnmetNeeds(report);
  info.missing = MissingOptions(report);
  info.arithmetic = AvailableArithmetic(report);
  info.refusal = RefusalText(info.unmet);
  return info;
}

// Returns the subgroup sizes that a device offers and the passes support.
Subgroups FindSubgroups(const vk::raii::PhysicalDevice& device) {
  Subgroups found{
      .size = device.getProperties2<vk::PhysicalDeviceProperties2, vk::PhysicalDeviceSubgroupProperties>()
                  .get<vk::PhysicalDeviceSubgroupProperties>()
                  .subgroupSize};
  const auto extensions = device.enumerateDeviceExtensionProperties();
  if (std::ranges::none_of(extensions, [](const vk::ExtensionProperties& extension) {
        return std::strcmp(extension.extensionName, VK_EXT_SUBGROUP_SIZE_CONTROL_EXTENSION_NAME) == 0;
      }))
    return found;
  const auto features =
      device.getFeatures2<vk::PhysicalDeviceFeatures2, vk::PhysicalDeviceSubgroupSizeControlFeatures>()
          .get<vk::PhysicalDeviceSubgroupSizeControlFeatures>();
  const auto sizes =
      device.getProperties2<vk::PhysicalDeviceProperties2, vk::PhysicalDeviceSubgroupSizeControlProperties>()
          .get<vk::PhysicalDeviceSubgroupSizeControlProperties>();
  found.can_choose =
      features.subgroupSizeControl && (sizes.requiredSubgroupSizeStages & vk::ShaderStageFlagBits::eCompute);
  found.can_be_full = features.computeFullSubgroups;
  found.min_size = std::max(sizes.minSubgroupSize, kMinSubgroup);
  found.max_size = std::min(sizes.maxSubgroupSize, kGroupSize);
  return found;
}

// Returns all devices, sorted by Rank.
std::vector<vk::raii::PhysicalDevice> Devices(const vk::raii::Instance& instance) {
  vk::raii::PhysicalDevices found(instance);
  std::vector<vk::raii::PhysicalDevice> devices;
  for (auto& device : found) devices.push_back(std::move(device));
  std::stable_sort(devices.begin(), devices.end(), [](const auto& a, const auto& b) {
    return Rank(a.getProperties().deviceType) < Rank(b.getProperties().deviceType);
  });
  return devices;
}

// Whether a validation message is a known false alarm. The layers treat a buffer as a whole: they require a
// barrier if a pass wrote any words of the frame buffer before a dispatch reads its number of workgroups from
// that buffer. The barrier is not needed: only pick_points and earlier passes write the words that the
// dispatch reads, and the barrier after pick_points already covers indirect reads.
bool IsOtherWordsOfFrame(const VkDebugUtilsMessengerCallbackDataEXT& data) {
  return data.pMessageIdName != nullptr && std::strstr(data.pMessageIdName, "SYNC-HAZARD-READ-AFTER-WRITE") &&
         std::strstr(data.pMessage, "for indirect VkBuffer") && data.objectCount > 0 &&
         data.pObjects[0].pObjectName != nullptr &&
         std::strcmp(data.pObjects[0].pObjectName, kFrameBufferName) == 0;
}

// Counts and prints a validation message. @param user  the SharedInstance
VKAPI_ATTR VkBool32 VKAPI_CALL OnValidation(VkDebugUtilsMessageSeverityFlagBitsEXT,
                                            VkDebugUtilsMessageTypeFlagsEXT,
                                            const VkDebugUtilsMessengerCallbackDataEXT* data, void* user) {
  if (IsOtherWordsOfFrame(*data)) return VK_FALSE;
  ++static_cast<SharedInstance*>(user)->messages;
  std::fprintf(stderr, "vulkan validation: %s\n", data->pMessage);
  return VK_FALSE;
}

/// Vulkan could not be opened, and the loader has reported why.
class OpeningError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Appends an error message of Vulkan's loader to a text, unless the text already contains it. @param user the
// text, a std::string
VKAPI_ATTR VkBool32 VKAPI_CALL OnLoaderError(VkDebugUtilsMessageSeverityFlagBitsEXT,
                                             VkDebugUtilsMessageTypeFlagsEXT,
                                             const VkDebugUtilsMessengerCallbackDataEXT* data, void* user) {
  std::string& loader_errors = *static_cast<std::string*>(user);
  const std::string_view message(data->pMessage);
  // the error that is returned to the user states this
  if (message.find("Found no drivers") != message.npos) return VK_FALSE;
  if (loader_errors.find(message) == loader_errors.npos)
    loader_errors.append(loader_errors.empty() ? " " : "; ").append(message);
  return VK_FALSE;
}

/// Makes the instance with these extensions and with VK_EXT_debug_utils, which delivers messages. If it
/// throws, the exception's text includes the loader's messages.
void Open(SharedInstance& made, vk::InstanceCreateInfo create, std::vector<const char*> extensions) {
  std::string& loader_messages = made.loader_errors;
  vk::DebugUtilsMessengerCreateInfoEXT listen({}, vk::DebugUtilsMessageSeverityFlagBitsEXT::eError,
                                              vk::DebugUtilsMessageTypeFlagBitsEXT::eGeneral, OnLoaderError,
                                              &loader_messages);
  listen.pNext = create.pNext;
  create.pNext = &listen;
  extensions.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
  create.setPEnabledExtensionNames(extensions);
  try {
    made.instance.emplace(made.loader, create);
  } catch (const vk::LayerNotPresentError&) {
    throw;
  } catch (const std::exception& error) {
    if (loader_messages.empty()) throw;
    throw OpeningError(OpeningFailure(error) + "; Vulkan's loader says:" + loader_messages);
  }
}

// Makes an instance, with or without the validation layers.
std::shared_ptr<SharedInstance> MakeInstance(bool validation) {
  auto made = std::make_shared<SharedInstance>();
  const vk::ApplicationInfo application("osteon", 1, nullptr, 0, VK_API_VERSION_1_2);
  std::vector<const char*> layers, extensions;
  vk::InstanceCreateInfo create({}, &application);
  const vk::ValidationFeatureEnableEXT synchronization =
      vk::ValidationFeatureEnableEXT::eSynchronizationValidation;
  const vk::ValidationFeaturesEXT features(synchronization);
  if (validation) {
    layers.push_back("VK_LAYER_KHRONOS_validation");
    extensions.push_back(VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME);
    create.pNext = &features;
  }
  create.setPEnabledLayerNames(layers);
  Open(*made, create, extensions);
  if (!validation) return made;
  using Severity = vk::DebugUtilsMessageSeverityFlagBitsEXT;
  using Type = vk::DebugUtilsMessageTypeFlagBitsEXT;
  made->messenger.emplace(*made->instance, vk::DebugUtilsMessengerCreateInfoEXT(
                                               {}, Severity::eWarning | Severity::eError,
                                               Type::eValidation | Type::eGeneral | Type::ePerformance,
                                               OnValidation, made.get()));
  return made;
}

// Returns the process's instance. It is never released, because unloading a driver at the process's end would
// destroy data that the driver's globals still use. If the instance cannot be made (no driver, no layers),
// the next call tries again.
std::shared_ptr<SharedInstance> OpenInstance(bool validation) {
  if (validation) {
    static const auto& layered = *new std::shared_ptr<SharedInstance>(MakeInstance(true));
    return layered;
  }
  static const auto& plain = *new std::shared_ptr<SharedInstance>(MakeInstance(false));
  return plain;
}

}  // namespace

DeviceReport ReportOf(const vk::raii::PhysicalDevice& device) {
  const auto properties =
      device.getProperties2<vk::PhysicalDeviceProperties2, vk::PhysicalDeviceSubgroupProperties>();
  DeviceReport report{.properties = properties.get<vk::PhysicalDeviceProperties2>().properties,
                      .subgroups = properties.get<vk::PhysicalDeviceSubgroupProperties>(),
                      .features = {},
                      .has_compute_queue = ComputeFamily(device).has_value()};
  report.subgroups.pNext = nullptr;
  // a device of an older API does not report the features of Vulkan 1.2
  if (report.properties.apiVersion < VK_API_VERSION_1_2) return report;
  const auto features =
      device.getFeatures2<vk::PhysicalDeviceFeatures2, vk::PhysicalDeviceVulkan12Features>();
  report.features = {.core = features.get<vk::PhysicalDeviceFeatures2>().features,
                     .vulkan12 = features.get<vk::PhysicalDeviceVulkan12Features>()};
  report.features.vulkan12.pNext = nullptr;
  return report;
}

tl::expected<std::vector<DeviceInfo>, std::string> ListDevices() try {
  std::vector<DeviceInfo> infos;
  for (const auto& device : Devices(*OpenInstance(false)->instance)) infos.push_back(Inspect(device));
  if (infos.empty()) return tl::make_unexpected(std::string(kNoDriver));
  return infos;
} catch (const std::exception& error) {
  return tl::make_unexpected(OpeningFailure(error));
}

std::string OpeningFailure(const std::exception& error) {
  if (dynamic_cast<const vk::LayerNotPresentError*>(&error))
    return "validation layers are not installed (package vulkan-validationlayers)";
  if (dynamic_cast<const OpeningError*>(&error)) return error.what();
  if (dynamic_cast<const vk::IncompatibleDriverError*>(&error)) return kNoDriver;
  // if the loader's library is missing, vulkan_raii throws an error of its own with this text
  if (std::strstr(error.what(), "Failed to load vulkan library")) return kNoDriver;
  return std::string("Vulkan could not be opened: ") + error.what();
}

tl::expected<std::unique_ptr<Context>, std::string> OpenContext(const std::string& name, bool validation,
                                                                Arithmetic arithmetic) try {
  auto context = std::make_unique<Context>();
  context->shared = OpenInstance(validation);
  context->validation = validation;
  std::vector<vk::raii::PhysicalDevice> devices = Devices(*context->shared->instance);
  if (devices.empty()) return tl::make_unexpected(std::string(kNoDriver));

  std::string seen;
  for (auto& device : devices) {
    const DeviceInfo info = Inspect(device);
    seen += "\n  " + info.name + (info.refusal.empty() ? "" : " (unusable: " + info.refusal + ")");
    if (context->physical || !info.refusal.empty()) continue;
    if (!name.empty() && Lower(info.name).find(Lower(name)) == std::string::npos) continue;
    context->info = info;
    context->physical = std::move(device);
  }
  if (!context->physical)
    return tl::make_unexpected((name.empty() ? std::string("no usable Vulkan device")
                                             : "no usable Vulkan device is called \"" + name + "\"") +
                               "; found:" + seen);

  context->queue_family = *ComputeFamily(*context->physical);
  const float priority = 1.0f;
  const vk::DeviceQueueCreateInfo queue({}, context->queue_family, 1, &priority);
  context->arithmetic = arithmetic == Arithmetic::kAuto ? context->info.arithmetic : arithmetic;
  if (arithmetic != Arithmetic::kAuto && !Offers(ReportOf(*context->physical), arithmetic))
    return tl::make_unexpected(ArithmeticText(context->arithmetic) + ": " + context->info.name +
                               " lacks them: " + RefusalText(context->info.missing));
  DeviceFeatures features = NeededFeatures(context->arithmetic);
  vk::DeviceCreateInfo create({}, queue);
  create.pEnabledFeatures = &features.core;
  create.pNext = &features.vulkan12;
  context->subgroups = FindSubgroups(*context->physical);
  vk::PhysicalDeviceSubgroupSizeControlFeatures sizes(context->subgroups.can_choose,
                                                      context->subgroups.can_be_full);
  const char* const size_control = VK_EXT_SUBGROUP_SIZE_CONTROL_EXTENSION_NAME;
  if (sizes.subgroupSizeControl || sizes.computeFullSubgroups) {
    create.setPEnabledExtensionNames(size_control);
    features.vulkan12.pNext = &sizes;
  }
  // a software driver starts its worker threads while the device opens
  const DriverThreads threads;
  context->device.emplace(*context->physical, create);
  threads.PinWorkers();
  context->queue.emplace(*context->device, context->queue_family, 0);
  context->fused_fma = !HasDoubles(context->arithmetic) && HasFusedFma(*context);
  return context;
} catch (const std::exception& error) {
  return tl::make_unexpected(OpeningFailure(error));
}

void NameForLayers(const Context& context, const Buffer& buffer, const char* name) {
  if (!context.validation) return;
  const auto handle = reinterpret_cast<std::uint64_t>(static_cast<VkBuffer>(*buffer.buffer));
  context.device->setDebugUtilsObjectNameEXT({vk::ObjectType::eBuffer, handle, name});
}

std::vector<std::uint32_t> MemoryTypes(const vk::PhysicalDeviceMemoryProperties& memory,
                                       const vk::MemoryRequirements& needs, Placement placement) {
  using Property = vk::MemoryPropertyFlagBits;
  // memory properties for the placement, best first; every device has memory with the last ones
  const vk::MemoryPropertyFlags host = Property::eHostVisible | Property::eHostCoherent;
  const std::vector<vk::MemoryPropertyFlags> choices =
      placement == Placement::kDevice ? std::vector<vk::MemoryPropertyFlags>{Property::eDeviceLocal, {}}
      : placement == Placement::kShared
          ? std::vector<vk::MemoryPropertyFlags>{host | Property::eDeviceLocal, host}
      : placement == Placement::kUpload
          ? std::vector<vk::MemoryPropertyFlags>{host}
          : std::vector<vk::MemoryPropertyFlags>{host | Property::eHostCached, host};
  std::vector<std::uint32_t> types;
  for (const vk::MemoryPropertyFlags preferred : choices)
    for (std::uint32_t i = 0; i < memory.memoryTypeCount; ++i) {
      const vk::MemoryType& type = memory.memoryTypes[i];
      if ((needs.memoryTypeBits & (1u << i)) && (type.propertyFlags & preferred) == preferred &&
          memory.memoryHeaps[type.heapIndex].size >= needs.size && std::ranges::find(types, i) == types.end())
        types.push_back(i);
    }
  return types;
}

Buffer MakeBuffer(const Context& context, vk::DeviceSize size, Placement placement) {
  using Usage = vk::BufferUsageFlagBits;
  Buffer made;
  made.size = std::max<vk::DeviceSize>(size, 16);
  made.buffer =
      vk::raii::Buffer(*context.device, vk::BufferCreateInfo({}, made.size,
                                                             Usage::eStorageBuffer | Usage::eIndirectBuffer |
                                                                 Usage::eUniformTexelBuffer |
                                                                 Usage::eTransferSrc | Usage::eTransferDst));
  const vk::MemoryRequirements needs = made.buffer.getMemoryRequirements();
  const vk::PhysicalDeviceMemoryProperties memory = context.physical->getMemoryProperties();
  const std::uint32_t type = AllocateFromFirst(MemoryTypes(memory, needs, placement), [&](std::uint32_t i) {
    made.memory = vk::raii::DeviceMemory(*context.device, vk::MemoryAllocateInfo(needs.size, i));
  });
  made.buffer.bindMemory(*made.memory, 0);
  made.device_local =
      static_cast<bool>(memory.memoryTypes[type].propertyFlags & vk::MemoryPropertyFlagBits::eDeviceLocal);
  if (placement != Placement::kDevice) made.mapped = made.memory.mapMemory(0, VK_WHOLE_SIZE);
  return made;
}

}  // namespace osteon::gpu
