#include "kerf/io/obj.h"

#include "kerf/io/mapped_file.h"
#include "kerf/io/obj/obj_cursor.h"
#include "kerf/io/obj/obj_geometry.h"
#include "kerf/io/obj/obj_materials.h"
#include "kerf/io/obj/obj_scan.h"

namespace kerf {

Model parse_obj(std::span<const char> bytes, const std::string& name) {
  const std::span<const char> text = obj_text(bytes, name);
  const std::vector<ObjChunk> chunks = scan_obj(text);
  Model model;
  model.mesh = read_obj_geometry(text, chunks, name, model.notes);
  add_obj_materials(text, chunks, name, model);
  return model;
}

Model read_obj(const std::string& path) {
  const MappedFile file(path);
  return parse_obj(file.bytes(), path);
}

}  // namespace kerf
