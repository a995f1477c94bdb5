// Every mistake in a YAML scene is an error at its place, with the words that help.

#include <gtest/gtest.h>

#include "support/folder.h"
#include "yaml_text.h"

namespace kerf::test {
namespace {

TEST(YamlErrors, SyntaxErrorsHaveAPlace) {
  expect_error("camera: [1, 2\nsettings^:\n", {"no YAML", "end of sequence flow not found"});
  expect_error("camera:\n  fov: 1^: 2\n", {"illegal map value"});
  expect_error("camera:\n\tfov^: 1\n", {"tab"});
  expect_error("camera: ^*nobody\n", {"anchor is not defined"});
  expect_error("camera:\n  fov: ^@1\n", {"no YAML"});
  expect_error("scene:\n  name: ^\"cut off\n", {"has no end"});
  expect_error("scene:\n  name: ^'cut off''\n", {"has no end"});
  expect_error("scene:\n  name: &a # '\n    ^\"cut off\\\"\n", {"has no end"});
}

TEST(YamlErrors, WhatYamlCppLetsPassSilentlyIsRefused) {
  expect_error("camera: {}\n^---\ncamera: {}\n", {"second document"});
  expect_error("camera: {}\n^---\n", {"second document"});
  expect_error("camera: # a ^\x04 byte\n", {"\\x04", "UTF-8"});
  expect_error(std::string("c^\0a\0m\0", 7), {"\\x00"});
  expect_error("^\xFF\xFE camera", {"\\xff"});
  expect_error("camera:\n  fov: 40\n  up: [0, 0, 1]\n  ^fov: 50\n", {"second 'fov'", "line 2"});
  expect_error("camera: {}\n^camera: {}\n", {"second 'camera'", "line 1"});
  expect_error("camera:\n  ^<<: {fov: 4}\n", {"merge keys"});
  expect_error("camera:\n  fov: ^!!float 4\n", {"tags"});
  expect_error("camera: ^!!map {fov: 4}\n", {"tags"});
  expect_error("camera: ^!include x.yaml\n", {"tags", "include"});
  expect_error("a: &a [1, ^*a]\n", {"alias"});
  expect_error("camera:\n  ^[1, 2]: 3\n", {"expected a key of the camera", "a list of 2"});
  expect_error("? \n^: 3\n", {"expected a key"});
  expect_error("camera: {}\n^materials\n", {"a key without a ':' behind it"});
  expect_error("camera: {fov: 4, ^up}\n", {"up: expected three numbers, found nothing"});
  expect_error("camera: {}\n^%geometry: []\n", {"directives"});
  expect_error("^%TAG ! x\n---\ncamera: {}\n", {"directives"});
  expect_error("settings: {structure: ^\"a\\0b\"}\n", {"zero byte"});
}

TEST(YamlErrors, UnknownKeysNameTheNearestOne) {
  expect_error("^camra: {}\n", {"unknown key 'camra' of the scene file", "did you mean 'camera'?"});
  expect_error("camera:\n  fov: 40\n  ^aperture: 2\n",
               {"'aperture' of the camera; expected position, look_at, up or fov"});
  expect_error("settings: {^Ambient_light: 1}\n", {"did you mean 'ambient_light'?"});
  expect_error("scene:\n  ^matrials: []\n", {"unknown key 'matrials' of scene"});
  expect_error(with_material("name: x, type: lambertian, ^colour: [1, 1, 1]"),
               {"unknown key 'colour' of a lambertian material; did you mean 'color'?"});
  expect_error(with_material("name: x, type: light, ^emision: [1, 1, 1]"), {"of a light", "did you mean 'emission'?"});
  expect_error(with_item("type: sphere, ^centre: [0, 0, 0]"),
               {"unknown key 'centre' of a sphere; did you mean 'center'?"});
  expect_error(with_item("type: rectangle, material: m, ^radius: 1"), {"'radius' of a rectangle"});
  expect_error(with_item("type: obj, ^files: x"), {"of an obj; did you mean 'file'?"});
}

TEST(YamlErrors, MissingKeysAreNamed) {
  expect_error(at_material("type: mirror"), {"a mirror material needs 'name'"});
  expect_error(at_item("material: m"), {"needs 'type'"});
  expect_error(at_item("type: sphere, material: m, radius: 1"), {"a sphere needs 'center'"});
  expect_error(at_item("type: sphere, material: m, center: [0, 0, 0]"), {"a sphere needs 'radius'"});
  expect_error(at_item("type: sphere, center: [0, 0, 0], radius: 1"), {"a sphere needs 'material'"});
  expect_error(at_item("type: rectangle, material: m, corner: [0, 0, 0], u: [1, 0, 0]"), {"needs 'v'"});
  expect_error(at_item("type: triangle, material: m, v0: [0, 0, 0], v1: [1, 0, 0]"), {"needs 'v2'"});
  expect_error(at_item("type: obj"), {"an obj needs 'file'"});
}

TEST(YamlErrors, WrongTypesSayWhatWasExpectedAndFound) {
  expect_error("^[1, 2, 3]\n", {"the scene file: expected a map, found a list of 3"});
  expect_error("^hello\n", {"expected a map, found 'hello'"});
  expect_error("camera: ^3\n", {"camera: expected a map, found '3'"});
  expect_error("camera:\n  position: ^{x: 1}\n", {"position: expected three numbers, found a map"});
  expect_error("camera:\n  position: ^[1, 2]\n", {"expected three numbers, found a list of 2"});
  expect_error("camera:\n  position: ^[1, 2, 3, 4]\n", {"found a list of 4"});
  expect_error("camera:\n  position: [1, ^b, 3]\n", {"position: expected a number, found 'b'"});
  expect_error("camera:\n  position: [1, ^, 3]\n", {"position: expected a number, found nothing"});
  expect_error("camera:\n  ^fov:\n  up: [0, 1, 0]\n", {"fov: expected a number, found nothing"});
  expect_error("camera:\n  fov: ^\"40\"\n", {"fov: expected a number, found the quoted text '40'"});
  for (const std::string number : {"4x", "0x10", "1_000", "+-1", "1e", ".", "--1", "1 2", "inf", "nan", "1,5"}) {
    expect_error("camera:\n  fov: ^" + number + "\n", {"expected a number"});
  }
  expect_error("settings:\n  use_bvh: ^yes\n", {"use_bvh: expected true or false, found 'yes'"});
  expect_error("settings:\n  use_bvh: ^\"true\"\n", {"expected true or false, found the quoted text"});
  for (const std::string word : {"no", "on", "off", "1", "tRUE", "[true]"}) {
    expect_error("settings:\n  use_bvh: ^" + word + "\n", {"expected true or false"});
  }
  expect_error("settings:\n  structure: ^[a]\n", {"structure: expected a text, found a list of 1"});
  expect_error("settings:\n  structure: ^''\n", {"structure: must not be empty"});
  expect_error("materials: ^{name: x}\n", {"materials: expected a list, found a map"});
  expect_error("materials:\n  - ^x\n", {"materials: expected a map, found 'x'"});
  expect_error("geometry:\n  ^- {type: obj, file: x.ply}\n  -\n  - 4\n", {"item 2 of the list is empty"});
  expect_error(with_material("name: ^[x]"), {"name: expected a text"});
  expect_error(with_material("name: ^''"), {"name: must not be empty"});
}

TEST(YamlErrors, NumbersAreFiniteAndInTheirRange) {
  for (const std::string number : {".inf", "-.inf", ".nan"}) {
    expect_error("camera:\n  fov: ^" + number + "\n", {"must be finite", number.c_str()});
  }
  for (const std::string number : {"1e400", "2e36", "-2e36", "1e99999999"}) {
    expect_error("camera:\n  position: [0, ^" + number + ", 0]\n", {"2^120"});
  }
  expect_error("camera:\n  fov: ^180\n", {"fov: must be greater than 0 and less than 180, found 180"});
  expect_error("camera:\n  fov: ^-0\n", {"must be greater than 0"});
  expect_error("settings: {background_color: [0, ^-1, 0]}\n", {"background_color: must be at least 0, found -1"});
  expect_error("settings: {background_intensity: ^-1}\n", {"at least 0"});
  expect_error("settings: {ambient_light: ^-1}\n", {"at least 0"});
  expect_error(with_material("name: x, albedo: [1, 1, ^1.5]"), {"albedo: must be from 0 to 1, found 1.5"});
  expect_error(with_material("name: x, type: constant, albedo: [1, 1, ^-1]"), {"albedo: must be at least 0"});
  expect_error(with_material("name: x, emission: [1, 1, ^-1]"), {"emission: must be at least 0"});
  expect_error(with_material("name: x, type: metal, roughness: ^1.1"), {"roughness: must be from 0 to 1"});
  expect_error(with_material("name: x, type: metal, metallic: ^-1"), {"metallic: must be from 0 to 1"});
  expect_error(with_material("name: x, type: glass, transmission: ^2"), {"transmission: must be from 0 to 1"});
  expect_error(with_material("name: x, type: glass, refractive_index: ^0"), {"must be greater than 0"});
  expect_error(with_item("type: sphere, material: m, center: [0, 0, 0], radius: ^0"), {"greater than 0"});
  expect_error(with_item("type: sphere, material: m, center: [0, 0, 0], radius: ^1e-60"),
               {"radius: 1e-60 is 0 in single precision"});
  expect_error(with_material("name: x, color: [1, 1, 1e30], emission_intensity: ^1e30"), {"2^120"});
}

TEST(YamlErrors, CamerasThatSeeNothingAreRefusedAtTheGuiltyKey) {
  expect_error("camera:\n  position: [1, 2, 3]\n  look_at: ^[1, 2, 3]\n", {"must differ"});
  expect_error("camera:\n  position: ^[0, 0, -1]\n", {"must differ"});
  expect_error("camera:\n  position: [0, 0, 1]\n  up: ^[0, 0, 3]\n", {"along its view"});
  expect_error("camera:\n  up: ^[0, 0, 0]\n", {"zero"});
  expect_error("camera:\n  look_at: ^[0, 5, 0]\n", {"along its view"});
}

TEST(YamlErrors, KeysThatExcludeEachOtherNameTheOther) {
  expect_error("geometry: []\n^geometries: []\n", {"'geometries' and 'geometry' of line 1 exclude each other"});
  expect_error("geometries: []\n\n^geometry: []\n", {"'geometry' and 'geometries' of line 1"});
  expect_error("camera: {}\nscene:\n  ^camera: {}\n", {"second 'camera'", "line 1"});
  expect_error("scene:\n  ambient_light: 1\nsettings:\n  ^ambient_light: 1\n", {"second 'ambient_light'", "line 2"});
  expect_error("settings:\n  use_bvh: false\n  ^structure: binned_sah\n", {"'structure' and 'use_bvh' of line 2"});
  expect_error("settings:\n  structure: binned_sah\nscene:\n  ^use_bvh: false\n", {"'use_bvh' and 'structure'"});
  expect_error(with_material("name: x, emission: [1, 1, 1], ^color: [1, 1, 1]"), {"'color' and 'emission'"});
  expect_error(with_material("emission_intensity: 2, name: x, ^emission: [1, 1, 1]"),
               {"'emission' and 'emission_intensity' of line 2"});
  expect_error(with_item("type: obj, file: a.ply, ^filename: b.ply"), {"'filename' and 'file'"});
}

TEST(YamlErrors, WhatIsNotThereYetSaysSo) {
  for (const std::string type : {"anisotropic_metal", "thin_film", "clear_coat"}) {
    expect_error(with_material("name: x, type: ^" + type + ", film_ior: 1.3"), {type.c_str(), "not there yet"});
  }
  expect_error(with_material("name: x, ^pattern: {type: stripes}"), {"'pattern' is not there yet"});
  expect_error(with_material("name: x, ^film_thickness: 300"),
               {"'film_thickness' belongs to thin_film, which is not there yet"});
  for (const std::string key : {"film_ior", "anisotropy", "preset", "eta", "k", "dot_count", "dot_radius"}) {
    expect_error(with_material("name: x, ^" + key + ": 1"), {key.c_str(), "not there yet"});
  }
  expect_error(with_item("type: ^displaced_sphere, radius: 1"), {"'displaced_sphere' is not there yet"});
}

TEST(YamlErrors, UnknownTypesAndMaterialsNameTheNearestOne) {
  expect_error(with_material("name: x, type: ^lambertain"),
               {"unknown material type 'lambertain'; did you mean 'lambertian'?"});
  expect_error(with_material("name: x, type: ^Glass"), {"did you mean 'glass'?"});
  expect_error(with_material("name: x, type: ^wood"), {"expected lambertian, mirror, metal", "rough_mirror"});
  expect_error(with_item("type: ^spere, material: m"), {"unknown shape 'spere'; did you mean 'sphere'?"});
  expect_error(with_item("type: ^teapot"), {"expected sphere, rectangle, triangle or obj"});
  const std::string rest = ", type: sphere, center: [0, 0, 0], radius: 1";
  const std::string named = "materials: [{name: brick}, {name: plaster}]\ngeometry:\n  - {material: ";
  expect_error(named + "^brik" + rest + "}\n", {"unknown material 'brik'; did you mean 'brick'?"});
  expect_error(named + "^w" + rest + "}\n", {"there is 'brick', 'plaster'"});
  expect_error("geometry:\n  - {material: ^m" + rest + "}\n", {"unknown material 'm'; the file has no materials"});
  expect_error("materials: [{name: brick}]\nscene: {name: &w wood}\ngeometry:\n  - {material: ^*w" + rest + "}\n",
               {"unknown material 'wood'"});
  expect_error("materials:\n  - name: a\n  - name: b\n  - name: ^a\n", {"second material 'a'", "line 2"});
}

TEST(YamlErrors, LightsMustShine) {
  const char* sentence = "a light needs an 'emission', or a 'color' and an 'emission_intensity', above 0";
  expect_error(at_material("name: x, type: light"), {sentence});
  expect_error(with_material("name: x, type: light, emission: ^[0, 0, 0]"), {sentence});
  expect_error(with_material("name: x, type: light, color: ^[0, 0, 0]"), {sentence});
  expect_error(with_material("name: x, type: light, emission_intensity: ^0"), {sentence});
}

TEST(YamlErrors, ShapesMustHaveAShape) {
  const std::string rectangle = "type: rectangle, material: m, corner: [0, 0, 0], ";
  expect_error(with_item(rectangle + "u: [1, 2, 3], v: ^[0, 0, 0]"), {"v: u and v", "parallel"});
  expect_error(with_item(rectangle + "u: [0.1, 0.2, 0.3], v: ^[0.3, 0.6, 0.9]"), {"parallel"});
  expect_error(at_item(rectangle + "u: [1e36, 0, 0], v: [1e36, 1e36, 0]"), {"2^120"});
  const std::string triangle = "type: triangle, material: m, v0: [0, 0, 0], v1: [1, 0, 0], v2: [0, 1, 0], ";
  expect_error(at_item(triangle + "n0: [0, 0, 1], n2: [0, 0, 1]"), {"'n1' is missing"});
  expect_error(with_item(triangle + "n0: [0, 0, 1], n1: ^[0, 0, 0], n2: [0, 0, 1]"), {"n1", "zero"});
  expect_error(with_item("type: obj, file: x.ply, scale: ^[1, 0, 1]"), {"scale: no component may be 0"});
  expect_error(with_item("type: obj, file: x.ply, scale: ^0"), {"scale: no component may be 0"});
  expect_error(with_item("type: obj, file: x.ply, scale: ^[1, 2]"),
               {"scale: expected a number or three of them, found a list of 2"});
}

TEST(YamlErrors, FilesThatCannotBeReadAreNamed) {
  const Folder folder;
  const auto what = [](const std::string& path) {
    try {
      read_yaml_scene(path);
    } catch (const Error& error) {
      EXPECT_EQ(error.place(), path);
      return std::string(error.what());
    }
    return std::string("no error");
  };
  EXPECT_NE(what(folder.path("none.yaml")).find("no such file"), std::string::npos);
  EXPECT_NE(what(folder.path("")).find("is a folder"), std::string::npos);
}

}  // namespace
}  // namespace kerf::test
