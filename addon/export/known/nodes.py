# SPDX-License-Identifier: GPL-3.0-or-later
"""Shader nodes: of those that we follow every input and property, the others by what becomes of them."""

from __future__ import annotations

from . import Node, Socket

_WEIGHT = "hidden, and read by nobody"

_PHASES = {
    "details of other phase functions than Henyey-Greenstein's, which are named as a whole": (
        "IOR", "Backscatter", "Alpha", "Diameter"),
    _WEIGHT: ("Weight",),
}  # fmt: skip

FOLLOWED = (
    Node(
        "ShaderNodeBsdfPrincipled",
        ("Base Color", "Normal", "Metallic", "Roughness", "Diffuse Roughness", "Anisotropic", "Anisotropic Rotation", "Specular",
         "IOR", "Specular IOR Level", "Specular Tint", "Coat Weight", "Coat Roughness", "Coat IOR", "Coat Tint",
         "Clearcoat", "Clearcoat Roughness", "Sheen", "Sheen Weight", "Sheen Tint", "Sheen Roughness", "Emission",
         "Emission Color", "Emission Strength", "Alpha", "Transmission", "Transmission Weight", "distribution"),
        (
            Socket("Coat Normal", (), "the coat is as the surface is", unless=("Coat Weight", 0.0)),
            Socket("Subsurface", (0.0,), "it is diffuse"),
            Socket("Subsurface Weight", (0.0,), "it is diffuse"),
            Socket("Clearcoat Normal", (), "the clearcoat is as the surface is", unless=("Clearcoat", 0.0)),
            Socket("Thin Film Thickness", (0.0,), "there is no film"),
            Socket("Thin Wall", (False,), "it is solid"),
            Socket("Tangent", (), "it runs around the object's Z axis", unless=("Anisotropic", 0.0)),
        ),
        idle={
            "details of Subsurface, which is named as a whole": (
                "Subsurface Radius", "Subsurface Color", "Subsurface IOR", "Subsurface Anisotropy", "Subsurface Scale",
                "subsurface_method"),
            "details of light that is bent, which is named as a whole": (
                "Transmission Roughness", "Transmission Dispersion Scale", "Transmission Dispersion Abbe Number"),
            "details of Thin Film, which is named as a whole": ("Thin Film IOR",),
            _WEIGHT: ("Weight",),
        },
    ),
    Node("ShaderNodeBsdfDiffuse", ("Color", "Roughness", "Normal"), idle={_WEIGHT: ("Weight",)}),
    Node("ShaderNodeBsdfGlossy", ("Color", "Roughness", "distribution", "Normal"), idle={_WEIGHT: ("Weight",)}),
    Node(
        "ShaderNodeBsdfAnisotropic",
        ("Color", "Roughness", "Anisotropy", "Rotation", "distribution", "Normal"),
        (Socket("Tangent", (), "it runs around the object's Z axis", unless=("Anisotropy", 0.0)),),
        idle={_WEIGHT: ("Weight",)},
    ),
    Node(
        "ShaderNodeBsdfGlass",
        ("Color", "Roughness", "IOR", "Normal", "distribution"),
        (Socket("Thin Film Thickness", (0.0,), "there is no film"),),
        idle={"details of Thin Film, which is named as a whole": ("Thin Film IOR",), _WEIGHT: ("Weight",)},
    ),
    Node(
        "ShaderNodeBsdfRefraction",
        ("Color", "Roughness", "IOR", "distribution"),
        idle={"light that goes straight through meets no facets": ("Normal",), _WEIGHT: ("Weight",)},
    ),
    Node("ShaderNodeBsdfTranslucent", ("Color", "Normal"), idle={_WEIGHT: ("Weight",)}),
    Node("ShaderNodeBsdfVelvet", ("Color", "Sigma", "Normal"), idle={_WEIGHT: ("Weight",)}),
    Node("ShaderNodeBsdfSheen", ("Color", "Roughness", "Normal", "distribution"), idle={_WEIGHT: ("Weight",)}),
    Node("ShaderNodeBsdfTransparent", ("Color",), idle={_WEIGHT: ("Weight",)}),
    Node(
        "ShaderNodeBsdfHairPrincipled",
        ("Color", "Melanin", "Melanin Redness", "Tint", "Absorption Coefficient", "Roughness", "Radial Roughness", "Coat",
         "IOR", "Offset", "Random Color", "Random Roughness", "Random", "parametrization"),
        elsewhere=("model",),
        idle={
            "details of Huang's model, which is named as a whole": (
                "Aspect Ratio", "Reflection", "Transmission", "Secondary Reflection"),
            _WEIGHT: ("Weight",),
        },
    ),
    Node("ShaderNodeMixShader", ("Shader",), elsewhere=("Fac", "Factor")),
    Node("ShaderNodeAddShader", ("Shader",)),
    Node("ShaderNodeEmission", ("Color", "Strength"), idle={_WEIGHT: ("Weight",)}),
    Node("ShaderNodeBackground", ("Color", "Strength"), idle={_WEIGHT: ("Weight",)}),
    Node(
        "ShaderNodeVolumePrincipled",
        ("Color", "Color Attribute", "Density", "Density Attribute", "Anisotropy", "Absorption Color",
         "Emission Strength", "Emission Color", "Blackbody Intensity", "Blackbody Tint", "Temperature",
         "Temperature Attribute"),
        idle={_WEIGHT: ("Weight",)},
    ),
    Node("ShaderNodeVolumeScatter", ("Color", "Density", "Anisotropy"), elsewhere=("phase",), idle=_PHASES),
    Node("ShaderNodeVolumeAbsorption", ("Color", "Density"), idle={_WEIGHT: ("Weight",)}),
    Node(
        "ShaderNodeVolumeCoefficients",
        ("Absorption Coefficients", "Scatter Coefficients", "Emission Coefficients", "Anisotropy"),
        elsewhere=("phase",),
        idle=_PHASES,
    ),
    Node(
        "ShaderNodeOutputMaterial",
        ("Surface", "Volume", "is_active_output", "target"),
        (Socket("Displacement", (), "the surface is as its mesh is"),),
        idle={"EEVEE alone reads it": ("Thickness",)},
    ),
    Node("ShaderNodeOutputWorld", ("Surface", "Volume", "is_active_output", "target")),
    Node("ShaderNodeOutputLight", ("Surface", "is_active_output", "target")),
    Node("ShaderNodeRGB", ("Color",)),
    Node("ShaderNodeValue", ("Value",)),
)  # fmt: skip

# What becomes of the others, and their names without "ShaderNode".
SURFACES = "BsdfHair BsdfMetallic BsdfRayPortal BsdfToon " "Holdout Script SubsurfaceScattering"
EVERYWHERE = (
    "Attribute Blackbody BrightContrast Clamp CombineColor CombineHSV CombineRGB CombineXYZ Gamma Group HueSaturation "
    "Invert MapRange Math Mix MixRGB RGBToBW SeparateColor SeparateHSV SeparateRGB SeparateXYZ ValToRGB"
)
OUTSIDE_VOLUMES = (
    "Mapping NewGeometry TexBrick TexChecker TexCoord TexGradient TexMagic TexMusgrave TexNoise TexVoronoi TexWave "
    "TexWhiteNoise VectorMath"
)
ON_SURFACES = "Bump Fresnel LayerWeight NormalMap ObjectInfo TexImage UVMap VertexColor"
IN_WORLDS = "LightPath TexEnvironment TexSky"
IN_VOLUMES = "VolumeInfo"
VALUES = (
    "AmbientOcclusion Bevel CameraData Displacement FloatCurve HairInfo LightFalloff "
    "Normal ParticleInfo PointInfo RGBCurve RadialTiling Raycast Squeeze Tangent "
    "TexGabor TexIES TexPointDensity VectorCurve VectorDisplacement VectorRotate "
    "VectorTransform Wavelength Wireframe"
)
NOT_IN_CYCLES = (
    "EeveeSpecular LightAccumulation LightEvaluation LightInfo LightIterInternalInput LightIterInternalOutput "
    "OutputLineStyle ShaderToRGB ShadowRaycast UVAlongStroke"
)
PASSES = "OutputAOV"
OTHERS = {
    "surfaces, named, and shown as diffuse in the material's viewport color": SURFACES,
    "followed on surfaces; in volumes, by what grids hold in each cell; and in worlds, by the direction": EVERYWHERE,
    "followed on surfaces and in worlds; elsewhere the link from them is named, and the input's own value used": (
        OUTSIDE_VOLUMES
    ),
    "followed on surfaces; elsewhere the link from them is named, and the input's own value used": ON_SURFACES,
    "followed in worlds; elsewhere the link from them is named, and the input's own value used": IN_WORLDS,
    "followed in volumes; elsewhere the link from them is named, and the input's own value used": IN_VOLUMES,
    "values and colors: the link from them is named, and the input's own value used": VALUES,
    "AOVs, which the view layer names": PASSES,
    "not there in Cycles": NOT_IN_CYCLES,
}
