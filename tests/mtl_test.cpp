// MTL: what becomes of its materials, and how an OBJ finds them and their textures.

#include "kerf/io/obj/mtl.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "kerf/base/error.h"
#include "kerf/io/obj.h"
#include "small_images.h"

namespace kerf::test {
namespace {

using Notes = std::vector<std::string>;
constexpr Vec3f kWhite{1, 1, 1};

MtlLibrary parse(const std::string& text) {
  const std::vector<char> bytes(text.begin(), text.end());  // so that the address sanitizer sees a read behind it
  return parse_mtl(bytes, "test.mtl");
}

/// The one material that has these statements.
Material material(const std::string& statements) {
  const MtlLibrary library = parse("newmtl m\n" + statements);
  EXPECT_EQ(library.materials.size(), 1U);
  return library.materials.at(0).material;
}

Notes notes(const std::string& statements) { return parse("newmtl m\n" + statements).notes; }

void expect_error(const std::string& text, int line, const std::string& sentence) {
  try {
    parse(text);
    FAIL() << text;
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::file);
    EXPECT_EQ(error.what(), fmt::format("test.mtl:{}: {}", line, sentence));
  }
}

TEST(Mtl, ReadsColoursAndEmission) {
  const Material m = material("Ka 1 1 1\nKd .1 .2 .3\nKs .5 .5 .5\nKe 10 20 30\nNs 100\nillum 2\nd 1\nTr 0\n");
  EXPECT_EQ(m.name, "m");
  EXPECT_EQ(m.type, MaterialType::lambertian);
  EXPECT_EQ(m.albedo, (Vec3f{0.1F, 0.2F, 0.3F}));
  EXPECT_EQ(m.emission, (Vec3f{10, 20, 30}));
  EXPECT_EQ(m.albedo_texture, kNoTexture);
  EXPECT_EQ(material("").albedo, Material().albedo);
  EXPECT_EQ(material("").emission, (Vec3f{0, 0, 0}));
  EXPECT_EQ(material("Kd 0 0 0\n").albedo, (Vec3f{0, 0, 0}));
  EXPECT_EQ(material("Kd .25\n").albedo, (Vec3f{0.25F, 0.25F, 0.25F}));
}

TEST(Mtl, KeywordsAreOfAnyCaseAndLinesOfAnyForm) {
  const Material m = material("  KD .1 .2 \\\r\n .3 # colour\r\n\r\n#\nke 1 2 3\r\n\tMAP_KA x.png\nMap_Bump x.png");
  EXPECT_EQ(m.albedo, (Vec3f{0.1F, 0.2F, 0.3F}));
  EXPECT_EQ(m.emission, (Vec3f{1, 2, 3}));
  EXPECT_EQ(parse("\xEF\xBB\xBFNewMtl a b\t c \r\n").materials.at(0).material.name, "a b\t c");
  EXPECT_TRUE(parse("# nothing\n").materials.empty());
}

TEST(Mtl, SharesAboveOneAreTakenAsOneWithANoteOfEachKind) {
  EXPECT_EQ(material("Kd 2 .5 1\n").albedo, (Vec3f{1, 0.5F, 1}));
  EXPECT_EQ(parse("newmtl a\nKd 2 2 2\nnewmtl b\nKd 2 0 0\nPr 3\nPm 1\nnewmtl c\nKd 2 1 1\n").notes,
            (Notes{"Kd above 1 is taken as 1 (material 'a' and 2 more)", "Pr above 1 is taken as 1 (material 'b')"}));
  EXPECT_TRUE(notes("Kd 1 1 1\nKe 50 50 50\n").empty());
}

TEST(Mtl, MirrorsAndMetallicMaterialsAreMetals) {
  for (const std::string& illum : std::vector<std::string>{"3", "5"}) {
    const Material mirror = material("Kd .1 .1 .1\nKs .8 .9 1\nillum " + illum + "\n");
    EXPECT_EQ(mirror.type, MaterialType::metal);
    EXPECT_EQ(mirror.albedo, (Vec3f{0.8F, 0.9F, 1}));
    EXPECT_EQ(mirror.metallic, 1.0F);
    EXPECT_EQ(mirror.roughness, 0.0F);
    EXPECT_EQ(material("Kd .1 .2 .3\nKs 0 0 0\nillum " + illum + "\n").albedo, (Vec3f{0.1F, 0.2F, 0.3F}));
  }
  const Material metallic = material("Kd .1 .2 .3\nKs .5 .5 .5\nPm .75\nPr .25\nNs 10\n");
  EXPECT_EQ(metallic.type, MaterialType::metal);
  EXPECT_EQ(metallic.albedo, (Vec3f{0.1F, 0.2F, 0.3F}));
  EXPECT_EQ(metallic.metallic, 0.75F);
  EXPECT_EQ(metallic.roughness, 0.25F);
  EXPECT_EQ(material("Pm 0\n").type, MaterialType::lambertian);
  EXPECT_EQ(material("illum 3\nNs 30\n").roughness, 0.5F);  // (2 / 32)^(1/4)
  EXPECT_EQ(material("illum 3\nNs 0\n").roughness, 1.0F);
  EXPECT_EQ(material("illum 3\nNs -1.960784\n").roughness, 1.0F);
  EXPECT_EQ(notes("Ns -1.960784\n"), (Notes{"Ns below 0 is taken as 0 (material 'm')"}));
}

TEST(Mtl, GlassByItsIlluminationModel) {
  for (const std::string& illum : std::vector<std::string>{"4", "6", "7", "9"}) {
    const Material glass = material("Kd .1 .2 .3\nNi 1.3\nillum " + illum + "\n");
    EXPECT_EQ(glass.type, MaterialType::glass);
    EXPECT_EQ(glass.albedo, kWhite);
    EXPECT_EQ(glass.refractive_index, 1.3F);
    EXPECT_EQ(glass.transmission, 1.0F);
    EXPECT_EQ(material("illum " + illum + "\n").refractive_index, 1.5F);
    EXPECT_EQ(material("d .25\nillum " + illum + "\n").transmission, 0.75F);
  }
}

TEST(Mtl, WhatIsNotOpaqueLetsLightThrough) {
  const Material half = material("Kd .1 .2 .3\nd .75\n");
  EXPECT_EQ(half.type, MaterialType::glass);
  EXPECT_EQ(half.albedo, (Vec3f{0.1F, 0.2F, 0.3F}));
  EXPECT_EQ(half.transmission, 0.25F);
  EXPECT_EQ(half.refractive_index, 1.0F);
  EXPECT_EQ(material("d .75\nNi 1.4\n").refractive_index, 1.4F);
  EXPECT_EQ(material("Kd 0 0 0\nd .75\n").albedo, kWhite);
  EXPECT_EQ(material("Tr .75\n").transmission, 0.75F);
  EXPECT_EQ(material("d -halo .75\n").transmission, 0.25F);
  EXPECT_EQ(material("d 0\n").transmission, 1.0F);
  // Where both stand, d counts, in either order.
  EXPECT_EQ(material("d .75\nTr .5\n").transmission, 0.25F);
  EXPECT_EQ(material("Tr 1\nd 1\n").type, MaterialType::lambertian);
  // MeshLab writes this for what is opaque.
  EXPECT_EQ(material("Tr 1\n").type, MaterialType::lambertian);
  EXPECT_EQ(notes("Tr 1\n"), (Notes{"Tr 1 without d is taken as opaque (material 'm')"}));
  EXPECT_EQ(material("Ni 1.5\nd 1\n").type, MaterialType::lambertian);
  EXPECT_EQ(material("Ni 0\n").type, MaterialType::lambertian);  // some programs write it where it means nothing
}

TEST(Mtl, OtherTexturesAndOptionsAreSaidOnceEach) {
  EXPECT_EQ(parse("newmtl a\nmap_Ka x.png\nmap_Bump -bm 2 x.png\nnewmtl b\nmap_Bump y.png\nmap_Bump z.png\n").notes,
            (Notes{"map_Ka is not shown (material 'a')", "map_Bump is not shown (material 'a' and 1 more)"}));
  EXPECT_TRUE(notes("Ka 0 0 0\nTf 1 1 1\nsharpness 60\nPs 0\nPc 0\nPcr 0\naniso 0\nanisor 0\nKm 1\n").empty());
  EXPECT_EQ(notes("Kd spectral file.rfl 1\n"),
            (Notes{"Kd is passed over where it is given as 'spectral' (material 'm')"}));
}

TEST(Mtl, AMapMayHaveOptionsAndBlanksInItsName) {
  const auto map = [](const std::string& statement) {
    return parse("newmtl m\n" + statement).materials.at(0).albedo_map;
  };
  EXPECT_EQ(map("map_Kd a b.png\n"), "a b.png");
  EXPECT_EQ(map("map_Kd  -s 1 1 1 -o 0.5 0 -clamp on -mm 0 1 C:\\maps\\1 #2.png \r\n"), "C:\\maps\\1 #2.png");
  EXPECT_EQ(map("map_kd -s 2 2.png\n"), "2.png");
  EXPECT_EQ(map("map_Kd -BLENDU off a-b.png\n"), "a-b.png");
  EXPECT_EQ(map("map_Kd\n"), "");
  EXPECT_EQ(notes("map_Kd\n"), (Notes{"map_Kd names no file (material 'm')"}));
  EXPECT_EQ(notes("map_Kd -s 2 2 2 -clamp on a.png\n"),
            (Notes{"the option -s of map_Kd is passed over (material 'm')",
                   "the option -clamp of map_Kd is passed over (material 'm')"}));
}

TEST(Mtl, OfTwoMaterialsOfOneNameTheFirstCounts) {
  const MtlLibrary library = parse("newmtl a\nKd 1 0 0\nnewmtl a\nKd 0 1 0\nnewmtl b\n");
  ASSERT_EQ(library.materials.size(), 2U);
  EXPECT_EQ(library.materials[0].material.albedo, (Vec3f{1, 0, 0}));
  EXPECT_EQ(library.notes, (Notes{"a second material of the same name is left out (material 'a')"}));
}

TEST(Mtl, ErrorsNameTheLineAndTheNearestRightWord) {
  expect_error("newmtl a\n\nKx 1 1 1\n", 3, "unknown keyword 'Kx'; did you mean 'Kd'?");
  expect_error("newmtl a\nmap_Dk x.png\n", 2, "unknown keyword 'map_Dk'; did you mean 'map_Kd'?");
  expect_error("newmtl a\n<html>\n", 2, "unknown keyword '<html>'");
  expect_error("Kd 1 1 1\n", 1, "'Kd' stands before the first newmtl");
  expect_error("newmtl \n", 1, "the line ends where the name of a material was expected");
  expect_error("newmtl a\nKd 1 1\n", 2, "the line ends where Kd was expected");
  expect_error("newmtl a\nKd\n", 2, "the line ends where Kd was expected");
  expect_error("newmtl a\nKd 1 1 1 1\n", 2, "found '1' behind Kd");
  expect_error("newmtl a\nKd 0,5 1 1\n", 2, "found '0,5' where Kd was expected");
  expect_error("newmtl a\nKd 1 -1 1\n", 2, "Kd is -1; it must not be negative");
  expect_error("newmtl a\nKs nan 1 1\n", 2, "Ks is nan; a finite number was expected");
  expect_error("newmtl a\nKe inf 1 1\n", 2, "Ke is inf; a finite number was expected");
  expect_error("newmtl a\nKe -1 1 1\n", 2, "Ke is -1; it must not be negative");
  expect_error("newmtl a\nd -0.5\n", 2, "d is -0.5; it must not be negative");
  expect_error("newmtl a\nTr x\n", 2, "found 'x' where Tr was expected");
  expect_error("newmtl a\nNs 1 2\n", 2, "found '2' behind Ns");
  expect_error("newmtl a\nillum 11\n", 2, "found '11' where an illumination model from 0 to 10 was expected");
  expect_error("newmtl a\nillum 2.5\n", 2, "found '2.5' where an illumination model from 0 to 10 was expected");
  expect_error("newmtl a\nillum\n", 2, "the line ends where a number of an illumination model was expected");
  expect_error("newmtl a\nillum 7\nNi 0\nKd 1 1 1\nnewmtl b\n", 3, "Ni is 0; that of glass must be greater than 0");
  expect_error("newmtl a\nNi -1\nd .5\n", 2, "Ni is -1; that of glass must be greater than 0");
  expect_error("newmtl a\nmap_Kd -clmp on x.png\n", 2, "unknown option '-clmp'; did you mean '-clamp'?");
  expect_error("newmtl a\nmap_Kd -s\n", 2, "the line ends where a value of -s was expected");
  expect_error("newmtl a\rKd 1 1 1\r", 1, "lines end with a carriage return alone; line feeds are expected");
}

/// A folder with an OBJ and what belongs to it.
class MtlFiles : public testing::Test {
 public:
  MtlFiles(const MtlFiles&) = delete;
  MtlFiles& operator=(const MtlFiles&) = delete;

 protected:
  MtlFiles() : folder_(testing::TempDir() + "kerf_mtl_test." + std::to_string(::getpid())) {
    std::filesystem::create_directories(folder_ + "/maps");
  }
  ~MtlFiles() override { std::filesystem::remove_all(folder_); }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ + "/" + name, std::ios::binary) << text;
  }

  /// An OBJ of a triangle for each of its lines that begins with '*'.
  Model read(std::string text) const {
    for (size_t at = 0; (at = text.find('*')) != text.npos;) text.replace(at, 1, "f 1 2 3");
    write("model.obj", text + "\nv 0 0 0\nv 1 0 0\nv 0 1 0\n");
    return read_obj(folder_ + "/model.obj");
  }

  std::string error_of(const std::string& text) const {
    try {
      read(text);
    } catch (const Error& error) {
      const std::string what = error.what();
      EXPECT_TRUE(what.starts_with(folder_ + "/")) << what;
      return what.substr(std::min(what.size(), folder_.size() + 1));
    }
    return "no error";
  }

  std::string folder_;
};

std::vector<std::string> names(const Model& model) {
  std::vector<std::string> all;
  for (const Material& material : model.materials) all.push_back(material.name);
  return all;
}

TEST_F(MtlFiles, TrianglesHaveTheMaterialsThatAreNamedBeforeThem) {
  write("a.mtl", "newmtl red\nKd 1 0 0\nnewmtl unused\nmap_Kd nowhere.png\nnewmtl two words\nKd 0 0 1\n");
  const Model model =
      read("mtllib a.mtl\n*\nusemtl two words \n*\n*\nusemtl unused\nusemtl red\r\n*\nusemtl\n*\nusemtl two words\n*");
  EXPECT_EQ(names(model), (std::vector<std::string>{"default", "two words", "red"}));
  EXPECT_EQ(model.mesh.materials, (std::vector<uint32_t>{0, 1, 1, 2, 0, 1}));
  EXPECT_EQ(model.materials[0].albedo, Material().albedo);
  EXPECT_EQ(model.materials[1].albedo, (Vec3f{0, 0, 1}));
  EXPECT_TRUE(model.notes.empty());
}

TEST_F(MtlFiles, AModelThatNamesNoMaterialHasNone) {
  write("a.mtl", "newmtl red\n");
  const Model model = read("mtllib a.mtl\n*\n");
  EXPECT_TRUE(model.materials.empty() && model.mesh.materials.empty() && model.notes.empty());
}

TEST_F(MtlFiles, SeveralLibrariesAndNamesWithBlanksAreFound) {
  write("a.mtl", "newmtl a\n");
  write("b.mtl", "newmtl b\nnewmtl a\nKd 0 0 0\n");
  write("a b.mtl", "newmtl ab\n");
  write("maps/c.mtl", "newmtl c\n");
  const Model model = read(
      "mtllib  a b.mtl \nmtllib a.mtl\tb.mtl a.mtl\nmtllib C:\\work\\maps\\c.mtl maps\\c.mtl\n"
      "usemtl a\n*\nusemtl b\n*\nusemtl ab\n*\nusemtl c\n*");
  EXPECT_EQ(names(model), (std::vector<std::string>{"a", "b", "ab", "c"}));
  EXPECT_EQ(model.materials[0].albedo, Material().albedo);
  // The first library of a name counts; of the full path on another machine not even the file's name is here.
  EXPECT_EQ(model.notes,
            (Notes{"the material library 'C:\\work\\maps\\c.mtl' was not found; default materials are used",
                   "the first of several material libraries counts for the material 'a'"}));
  write("c.mtl", "newmtl c\n");
  EXPECT_EQ(read("mtllib C:\\work\\maps\\c.mtl\nusemtl c\n*").notes, Notes());
  EXPECT_EQ(read("mtllib C:\\my work\\a b.mtl\nusemtl ab\n*").notes, Notes());
  EXPECT_EQ(names(read("mtllib a.mtl maps/c.mtl\nusemtl a\n*")), (std::vector<std::string>{"a"}));
}

TEST_F(MtlFiles, LibrariesThatAreMissingLeaveDefaultMaterials) {
  const Model model = read("mtllib x.mtl\nusemtl red\n*\nusemtl green\n*");
  EXPECT_EQ(names(model), (std::vector<std::string>{"red", "green"}));
  EXPECT_EQ(model.notes, (Notes{"the material library 'x.mtl' was not found; default materials are used"}));
  const Model bare = read("usemtl red\n*");
  EXPECT_EQ(names(bare), (std::vector<std::string>{"red"}));
  EXPECT_EQ(bare.notes, (Notes{"it names materials, but no library (mtllib); default ones are used"}));
  EXPECT_EQ(read("mtllib maps\nusemtl red\n*").notes.size(), 1U);  // a folder is no library
}

TEST_F(MtlFiles, AMaterialThatNoLibraryHasIsAnErrorWithTheNearestOne) {
  write("a.mtl", "newmtl wood\nnewmtl stone\n");
  EXPECT_EQ(error_of("mtllib a.mtl\nusemtl wodo\n*"),
            "model.obj:2: no material library has the material 'wodo'; did you mean 'wood'?");
  EXPECT_EQ(error_of("mtllib a.mtl\nusemtl x\n*"), "model.obj:2: no material library has the material 'x'");
  // It may be in the one that is missing.
  EXPECT_EQ(read("mtllib a.mtl x.mtl\nusemtl wodo\n*").notes.size(), 1U);
}

TEST_F(MtlFiles, ALibraryThatIsWrongIsAnErrorWithItsOwnPlace) {
  write("a.mtl", "newmtl a\nKd 1 2\n");
  EXPECT_EQ(error_of("mtllib a.mtl\n*"), "a.mtl:2: the line ends where Kd was expected");
}

TEST_F(MtlFiles, TexturesAreFoundAndLoadedOnce) {
  write("maps/red.bmp", bmp(1, 2, {{255, 0, 0}, {128, 0, 0}}));
  write("blue.bmp", bmp(1, 1, {{0, 0, 255}}));
  write("maps/a.mtl",
        "newmtl a\nmap_Kd red.bmp\nnewmtl b\nKd .5 .5 .5\nmap_Kd .\\red.bmp\nnewmtl c\nKd 0 0 0\nmap_Kd ..\\blue.bmp\n"
        "newmtl unused\nmap_Kd nowhere.png\n");
  const Model model = read("mtllib maps/a.mtl\nusemtl a\n*\nusemtl b\n*\nusemtl c\n*");
  ASSERT_EQ(model.textures.size(), 2U);
  EXPECT_EQ(model.textures[0].rgb, (std::vector<uint8_t>{255, 0, 0, 128, 0, 0}));
  EXPECT_EQ(model.textures[1].rgb, (std::vector<uint8_t>{0, 0, 255}));
  EXPECT_EQ(model.materials[0].albedo_texture, 0U);
  EXPECT_EQ(model.materials[0].albedo, kWhite);
  EXPECT_EQ(model.materials[1].albedo_texture, 0U);
  EXPECT_EQ(model.materials[1].albedo, (Vec3f{0.5F, 0.5F, 0.5F}));
  EXPECT_EQ(model.materials[2].albedo_texture, 1U);
  EXPECT_EQ(model.materials[2].albedo, kWhite);
  EXPECT_TRUE(model.notes.empty());
}

TEST_F(MtlFiles, TexturesThatCannotBeShownLeaveAColourAndANote) {
  write("a.dds", "DDS |");
  write("a.mtl",
        "newmtl a\nmap_Kd x.png\nnewmtl b\nmap_Kd x.png\nnewmtl c\nKd 1 0 0\nmap_Kd maps/a.dds\nnewmtl d\nillum "
        "4\nmap_Kd x.png\n");
  const Model model = read("mtllib a.mtl\nusemtl a\n*\nusemtl b\n*\nusemtl c\n*\nusemtl d\n*");
  EXPECT_TRUE(model.textures.empty());
  EXPECT_EQ(model.materials[1].albedo_texture, kNoTexture);
  EXPECT_EQ(model.materials[1].albedo, Material().albedo);
  EXPECT_EQ(model.materials[2].albedo, (Vec3f{1, 0, 0}));
  EXPECT_EQ(model.notes, (Notes{"map_Kd of glass is not shown (material 'd')", "the texture 'x.png' was not found",
                                "the texture 'a.dds' is not shown: it is not a PNG, JPEG, TGA or BMP"}));
  write("x.png", "no image");
  EXPECT_EQ(error_of("mtllib a.mtl\nusemtl a\n*"), "x.png: is not a PNG, JPEG, TGA or BMP image");
}

}  // namespace
}  // namespace kerf::test
