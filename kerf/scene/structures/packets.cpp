#include "kerf/trace/trace_packets.h"

#include "kerf/scene/structures/all.h"
#include "kerf/scene/structures/bvh2_structure.h"

namespace kerf {

std::unique_ptr<Structure> make_packets_structure(Bvh bvh, const StructureInput& input, const OptionValues& options) {
  constexpr uint32_t kSizes[] = {4, 8, 16};  // in the order of the words in all.h
  PacketTracer tracer;
  tracer.size = kSizes[static_cast<size_t>(options["size"])];
  input.limit.check(bvh.bytes());
  return std::make_unique<Bvh2Structure<PacketTracer>>(std::move(bvh), input, tracer);
}

}  // namespace kerf
