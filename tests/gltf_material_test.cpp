// glTF: what the triangles look like.

#include <gtest/gtest.h>

#include <cmath>

#include "gltf_text.h"
#include "kerf/io/image_write.h"

namespace kerf::test {
namespace {

/// A triangle with texture coordinates, of this material.
GltfMaker textured(const std::string& material) {
  GltfMaker gltf;
  gltf.accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, 3);
  gltf.accessor<float>({0, 0, 1, 0, 0.25F, 0.75F}, 2);
  gltf.mesh(R"("POSITION":0,"TEXCOORD_0":1)", R"(,"material":0)");
  gltf.nodes = {R"({"mesh":0})"};
  gltf.materials = {material};
  return gltf;
}

Material material_of(const std::string& text, std::vector<std::string> notes = {}) {
  const Model model = read(textured(text));
  expect_sound(model);
  EXPECT_EQ(model.mesh.materials, (std::vector<uint32_t>{0}));
  EXPECT_EQ(model.notes, notes);
  return model.materials.at(0);
}

/// A PNG of one colour per pixel, in a row.
std::string png(const Folder& folder, const std::string& name, const std::vector<Vec3f>& colors) {
  Image image{static_cast<uint32_t>(colors.size()), 1, 3, {}};
  for (const Vec3f& c : colors) image.pixels.insert(image.pixels.end(), {c.x, c.y, c.z});
  write_png(folder.path(name), image);
  return content_of(folder.path(name));
}

TEST(GltfMaterial, WithoutMetalItIsLambertian) {
  const Material material =
      material_of(R"({"name":"red","pbrMetallicRoughness":{"baseColorFactor":[0.5,0.25,0,1],"metallicFactor":0}})");
  EXPECT_EQ(material.name, "red");
  EXPECT_EQ(material.type, MaterialType::lambertian);
  EXPECT_EQ(material.albedo, (Vec3f{0.5F, 0.25F, 0}));
  EXPECT_EQ(material.albedo_texture, kNoTexture);
  EXPECT_EQ(material.emission, (Vec3f{0, 0, 0}));
}

TEST(GltfMaterial, MetalHasItsFactors) {
  const Material material = material_of(R"({"pbrMetallicRoughness":{"metallicFactor":0.75,"roughnessFactor":0.5}})");
  EXPECT_EQ(material.type, MaterialType::metal);
  EXPECT_EQ(material.metallic, 0.75F);
  EXPECT_EQ(material.roughness, 0.5F);
  EXPECT_EQ(material.albedo, (Vec3f{1, 1, 1}));
  const Material standard = material_of("{}");
  EXPECT_EQ(standard.type, MaterialType::metal);
  EXPECT_EQ(standard.metallic, 1);
  EXPECT_EQ(standard.roughness, 1);
}

TEST(GltfMaterial, EmissionHasAStrength) {
  EXPECT_EQ(material_of(R"({"emissiveFactor":[1,0.5,0]})").emission, (Vec3f{1, 0.5F, 0}));
  const std::string strong = R"({"emissiveFactor":[1,0.5,0],
      "extensions":{"KHR_materials_emissive_strength":{"emissiveStrength":20}}})";
  EXPECT_EQ(material_of(strong).emission, (Vec3f{20, 10, 0}));
}

TEST(GltfMaterial, TransmissionAndBlendingAreGlass) {
  const std::string smooth = R"("pbrMetallicRoughness":{"roughnessFactor":0,"baseColorFactor":[1,1,0.5,0.25]})";
  const Material glass = material_of("{" + smooth + R"(,"extensions":{
      "KHR_materials_transmission":{"transmissionFactor":0.5},"KHR_materials_ior":{"ior":2}}})");
  EXPECT_EQ(glass.type, MaterialType::glass);
  EXPECT_EQ(glass.transmission, 0.5F);
  EXPECT_EQ(glass.refractive_index, 2);
  EXPECT_EQ(glass.albedo, (Vec3f{1, 1, 0.5F}));
  EXPECT_EQ(material_of("{" + smooth + R"(,"extensions":{"KHR_materials_transmission":{"transmissionFactor":1}}})")
                .refractive_index,
            1.5F);
  const Material blended = material_of("{" + smooth + R"(,"alphaMode":"BLEND"})");
  EXPECT_EQ(blended.type, MaterialType::glass);
  EXPECT_EQ(blended.transmission, 0.75F);
  EXPECT_EQ(blended.refractive_index, 1);
  EXPECT_EQ(material_of("{" + smooth + "}").type, MaterialType::metal);  // opaque, whatever its alpha
  EXPECT_EQ(material_of("{" + smooth + R"(,"extensions":{"KHR_materials_transmission":{}}})").type,
            MaterialType::metal);
  material_of(R"({"extensions":{"KHR_materials_transmission":{"transmissionFactor":1}}})",
              {"rough glass is shown as smooth (materials[0])"});
  material_of(R"({"alphaMode":"MASK"})", {"holes cut by a mask are shown closed (materials[0])"});
}

TEST(GltfMaterial, UnlitIsConstantAndTheOldGlossinessHasItsColour) {
  const Material unlit =
      material_of(R"({"pbrMetallicRoughness":{"baseColorFactor":[0,1,0,1]},"extensions":{"KHR_materials_unlit":{}}})");
  EXPECT_EQ(unlit.type, MaterialType::constant);
  EXPECT_EQ(unlit.albedo, (Vec3f{0, 1, 0}));
  const Material glossy =
      material_of(R"({"extensions":{"KHR_materials_pbrSpecularGlossiness":{"diffuseFactor":[0,0,1,1]}}})",
                  {"of KHR_materials_pbrSpecularGlossiness only the diffuse part has an effect (materials[0])"});
  EXPECT_EQ(glossy.type, MaterialType::lambertian);
  EXPECT_EQ(glossy.albedo, (Vec3f{0, 0, 1}));
}

TEST(GltfMaterial, FactorsOutsideTheirRangeAreClampedAndSaidSo) {
  const Material material =
      material_of(R"({"pbrMetallicRoughness":{"baseColorFactor":[2,-1,0.5,1],"metallicFactor":7}})",
                  {"a factor outside [0, 1] is clamped (materials[0] and 2 more)"});
  EXPECT_EQ(material.albedo, (Vec3f{1, 0, 0.5F}));
  EXPECT_EQ(material.metallic, 1);
}

TEST(GltfMaterial, TrianglesWithoutOneHaveTheDefaultOfTheFormat) {
  GltfMaker gltf = triangle();
  gltf.materials = {R"({"pbrMetallicRoughness":{"metallicFactor":0}})"};
  const Model model = read(gltf);
  EXPECT_EQ(model.mesh.materials, (std::vector<uint32_t>{1}));
  ASSERT_EQ(model.materials.size(), 2U);
  EXPECT_EQ(model.materials[1].name, "default");
  EXPECT_EQ(model.materials[1].type, MaterialType::metal);
}

TEST(GltfMaterial, TexturesAreReadFromTheTextFromFilesAndFromBuffers) {
  const Folder folder;
  const std::string bytes = png(folder, "a b.png", {{1, 0, 0}, {0, 1, 0}});
  GltfMaker gltf = textured(R"({"pbrMetallicRoughness":{"baseColorTexture":{"index":0},"metallicFactor":0}})");
  gltf.textures = {R"({"source":0})", R"({"source":1})"};
  const std::string view = std::to_string(gltf.view(bytes));
  const std::string images[] = {R"({"uri":"a%20b.png"})", R"({"uri":"data:image/png;base64,)" + base64(bytes) + R"("})",
                                R"({"uri":"data:;base64,)" + base64(bytes) + R"("})",
                                R"({"mimeType":"image/png","bufferView":)" + view + "}"};
  for (const std::string& image : images) {
    gltf.images = {image, R"({"uri":"missing, but not used.png"})"};
    for (const std::string& text : {gltf.embedded(), gltf.glb()}) {
      const Model model = read(folder, text);
      expect_sound(model);
      EXPECT_TRUE(model.notes.empty());
      EXPECT_EQ(model.materials[0].albedo_texture, 0U);
      ASSERT_EQ(model.textures.size(), 1U);
      EXPECT_EQ(model.textures[0].width, 2U);
      EXPECT_EQ(model.textures[0].rgb, (std::vector<uint8_t>{255, 0, 0, 0, 255, 0}));
    }
  }
}

TEST(GltfMaterial, AnImageThatIsMissingOrNoneIsLeftOutAndSaidSo) {
  const Folder folder;
  folder.write("text.png", "no image");
  GltfMaker gltf = textured(R"({"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}})");
  gltf.textures = {R"({"source":0})"};
  for (const char* image : {"none.png", "text.png", "http://a/b.png", "data:;base64,AAAA"}) {
    gltf.images = {std::string(R"({"uri":")") + image + "\"}"};
    const Model model = read(folder, gltf.glb());
    EXPECT_EQ(model.materials[0].albedo_texture, kNoTexture);
    ASSERT_EQ(model.notes.size(), 1U) << image;
    EXPECT_TRUE(model.notes[0].starts_with("a texture is left out: images[0]")) << model.notes[0];
  }
  gltf.images = {R"({"uri":"none.png"})"};
  EXPECT_EQ(read(folder, gltf.glb()).notes[0],
            "a texture is left out: images[0] is at 'none.png': there is no such file");
  gltf.textures = {R"({"extensions":{"EXT_texture_webp":{"source":0}}})"};
  EXPECT_EQ(read(folder, gltf.glb()).notes[0], "a texture in a format that is not known is left out (textures[0])");
  gltf.textures = {R"({"source":4})"};
  EXPECT_EQ(refusal(folder, gltf.glb()), "textures[0] names images[4]; the file has 1");
  gltf.textures.clear();
  EXPECT_EQ(refusal(folder, gltf.glb()), "materials[0] names textures[0]; the file has 0");
  gltf.textures = {R"({"source":0})"};
  gltf.images = {R"({"bufferView":9})"};
  EXPECT_EQ(refusal(folder, gltf.glb()), "images[0] names bufferViews[9]; the file has 2");
}

TEST(GltfMaterial, OneThatNobodyUsesTakesNoImageAndNoNote) {
  GltfMaker gltf = textured("{}");
  gltf.materials.emplace_back(
      R"({"name":"idle","alphaMode":"MASK","pbrMetallicRoughness":{"baseColorTexture":{"index":0}}})");
  gltf.textures = {R"({"source":0})"};
  gltf.images = {R"({"uri":"none.png"})"};
  const Model model = read(gltf);
  EXPECT_TRUE(model.notes.empty());
  EXPECT_EQ(model.materials.at(1).name, "idle");
}

TEST(GltfMaterial, TheMeanOfATextureStandsForWhatHasNoTextureHere) {
  const Folder folder;
  png(folder, "orm.png", {{1, 0.2F, 0.4F}, {0, 0.6F, 1}});
  png(folder, "glow.png", {{1, 0, 0.5F}, {1, 1, 0.5F}});
  GltfMaker gltf = textured(R"({"pbrMetallicRoughness":{"metallicFactor":0.5,"roughnessFactor":0.5,
      "metallicRoughnessTexture":{"index":0}},"emissiveFactor":[1,2,4],"emissiveTexture":{"index":1}})");
  gltf.images = {R"({"uri":"orm.png"})", R"({"uri":"glow.png"})"};
  gltf.textures = {R"({"source":0})", R"({"source":1})"};
  const Model model = read(folder, gltf.glb());
  EXPECT_NEAR(model.materials[0].roughness, 0.5 * 0.4, 1e-6);
  EXPECT_NEAR(model.materials[0].metallic, 0.5 * 0.7, 1e-6);
  const double half = std::pow((128 / 255.0 + 0.055) / 1.055, 2.4);  // in linear light
  EXPECT_NEAR(model.materials[0].emission.x, 1, 1e-6);
  EXPECT_NEAR(model.materials[0].emission.y, 2 * 0.5, 1e-6);
  EXPECT_NEAR(model.materials[0].emission.z, 4 * half, 1e-6);
  EXPECT_TRUE(model.textures.empty());
  EXPECT_EQ(model.notes, (std::vector<std::string>{
                             "its mean colour stands for a texture of emission (materials[0])",
                             "its mean stands for a texture of metal and roughness (materials[0])",
                         }));
}

TEST(GltfMaterial, TextureCoordinatesCountFromBelow) {
  const Mesh mesh = read(textured("{}")).mesh;
  EXPECT_TRUE(mesh.uv_corners.empty());
  EXPECT_EQ(mesh.uvs, (std::vector<std::array<float, 2>>{{0, 1}, {1, 1}, {0.25F, 0.25F}}));
}

template <class T>
void expect_normalized_uvs() {
  GltfMaker gltf = textured("{}");
  const T most = std::numeric_limits<T>::max();
  gltf.accessor<T>({0, 0, most, 0, 0, most}, 2, R"(,"normalized":true)");
  gltf.meshes = {R"({"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":2}}]})"};
  EXPECT_EQ(read(gltf).mesh.uvs, (std::vector<std::array<float, 2>>{{0, 1}, {1, 1}, {0, 0}}));
}

TEST(GltfMaterial, TextureCoordinatesMayBeNormalizedIntegers) {
  expect_normalized_uvs<uint8_t>();
  expect_normalized_uvs<uint16_t>();
}

TEST(GltfMaterial, TheTextureSaysWhichSetOfCoordinatesAndWhereTheyAreMoved) {
  const Folder folder;
  png(folder, "a.png", {{1, 0, 0}});
  // The numbers of the Khronos test model: an arrow at 0.278 right of and below the centre is turned to its marker.
  GltfMaker gltf = textured(R"({"pbrMetallicRoughness":{"baseColorTexture":{"index":0,"texCoord":1,
      "extensions":{"KHR_texture_transform":{"rotation":0.39269908169872414}}}}})");
  gltf.materials.emplace_back(R"({"pbrMetallicRoughness":{"baseColorTexture":{"index":0,
      "extensions":{"KHR_texture_transform":{"offset":[0.5,-0.25],"scale":[2,3],"texCoord":1}}}}})");
  gltf.accessor<float>({0.42095F, 1.01627F, 0, 0, 1, 1}, 2);
  gltf.images = {R"({"uri":"a.png"})"};
  gltf.textures = {R"({"source":0})"};
  const std::string attributes = R"({"attributes":{"POSITION":0,"TEXCOORD_0":1,"TEXCOORD_1":2},"material":)";
  gltf.meshes = {R"({"primitives":[)" + attributes + "0}," + attributes + "1}]}"};
  const Mesh mesh = read(folder, gltf.glb()).mesh;
  expect_sound(mesh);
  EXPECT_EQ(mesh.vertices.size(), 3U);
  EXPECT_EQ(mesh.uv_corners, (Triangles{{0, 1, 2}, {3, 4, 5}}));
  ASSERT_EQ(mesh.uvs.size(), 6U);
  EXPECT_NEAR(mesh.uvs[0][0], 0.77782, 1e-4);
  EXPECT_NEAR(1 - mesh.uvs[0][1], 0.77782, 1e-4);
  EXPECT_EQ(mesh.uvs[4], (std::array<float, 2>{0.5F, 1.25F}));
  EXPECT_EQ(mesh.uvs[5], (std::array<float, 2>{2.5F, -1.75F}));
}

TEST(GltfMaterial, ATextureThatEndsAtItsBorderIsSaidToBeRepeatedWhereThatShows) {
  const Folder folder;
  png(folder, "a.png", {{1, 0, 0}});
  GltfMaker gltf = textured(R"({"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}})");
  gltf.images = {R"({"uri":"a.png"})"};
  gltf.textures = {R"({"source":0,"sampler":0})"};
  gltf.samplers = {R"({"wrapS":33071,"wrapT":10497})"};
  EXPECT_TRUE(read(folder, gltf.glb()).notes.empty());
  gltf.accessor<float>({0, 0, 1.5F, 0, 0, 0}, 2);
  gltf.meshes = {R"({"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":2},"material":0}]})"};
  EXPECT_EQ(
      read(folder, gltf.glb()).notes,
      (std::vector<std::string>{"a texture that is to be clamped or mirrored is repeated (meshes[0].primitives[0])"}));
  gltf.samplers = {"{}"};
  EXPECT_TRUE(read(folder, gltf.glb()).notes.empty());
}

TEST(GltfMaterial, ExtensionsOfTheWrongShapeAreRefused) {
  const auto refused = [](const std::string& material) { return refusal(textured(material)); };
  EXPECT_EQ(refused(R"({"extensions":{"KHR_materials_ior":3}})"),
            "materials[0].extensions.KHR_materials_ior is 3; expected an object");
  EXPECT_EQ(refused(R"({"extensions":{"KHR_materials_emissive_strength":{"emissiveStrength":"9"}}})"),
            "materials[0]: emissiveStrength must be a number");
  EXPECT_EQ(refused(R"({"extensions":{"KHR_materials_pbrSpecularGlossiness":{"diffuseFactor":[1,2,3]}}})"),
            "materials[0]: diffuseFactor must be an array of 4 numbers");
  EXPECT_EQ(refused(R"({"extensions":{"KHR_materials_pbrSpecularGlossiness":{"diffuseTexture":{"texCoord":0}}}})"),
            "materials[0]: diffuseTexture must be an object with the index of a texture");
  EXPECT_EQ(refused(R"({"pbrMetallicRoughness":{"baseColorFactor":[1,1]}})").substr(0, 16), "is no glTF 2.0: ");
}

}  // namespace
}  // namespace kerf::test
