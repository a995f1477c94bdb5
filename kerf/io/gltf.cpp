#include "kerf/io/gltf.h"

#include "kerf/io/gltf/gltf_container.h"
#include "kerf/io/gltf/gltf_file.h"
#include "kerf/io/gltf/gltf_material.h"
#include "kerf/io/gltf/gltf_mesh.h"
#include "kerf/io/gltf/gltf_scene.h"
#include "kerf/io/mapped_file.h"

namespace kerf {

Model read_gltf(const std::string& path) {
  const MappedFile mapped(path);
  GltfFile file = load_gltf(open_gltf_container(mapped.bytes(), path), path);
  const GltfScene scene = walk_gltf_scene(file);
  Model model;
  GltfMaterials materials(file);
  model.mesh = GltfMeshes(file, materials).copy(scene.instances);
  materials.finish(model);
  if (model.materials.empty()) model.mesh.materials.clear();
  model.camera = scene.camera;
  model.notes = file.notes.sentences();
  return model;
}

}  // namespace kerf
