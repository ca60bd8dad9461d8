using System.IO;
using UnrealBuildTool;

// The headers and the library lie in ThirdParty/, where `cmake --install --component unreal` puts them.
public class OsteonCutting : ModuleRules
{
    public OsteonCutting(ReadOnlyTargetRules Target) : base(Target)
    {
        PCHUsage = PCHUsageMode.UseExplicitOrSharedPCHs;
        CppStandard = CppStandardVersion.Cpp17;
        PublicDependencyModuleNames.AddRange(new[] { "Core", "CoreUObject", "Engine", "ProceduralMeshComponent" });
        string osteon = Path.Combine(PluginDirectory, "ThirdParty");
        string library = Path.Combine(osteon, "lib", "libosteon.so.0");
        PublicSystemIncludePaths.Add(Path.Combine(osteon, "include"));
        PublicAdditionalLibraries.Add(library);
        PublicRuntimeLibraryPaths.Add(Path.Combine(osteon, "lib"));
        RuntimeDependencies.Add(library);
        RuntimeDependencies.Add(Path.Combine(osteon, "config", "..."));
    }
}
