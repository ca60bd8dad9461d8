#pragma once

#include "Components/SceneComponent.h"
#include "CoreMinimal.h"
#include "OsteonTypes.h"
#include "ProceduralMeshComponent.h"
#include "osteon_host.h"

#include "OsteonBoneComponent.generated.h"

/// A bone that a tool cuts: a procedural mesh, one section a brick of the surface, that follows the cut.
///
/// Lengths and places are Unreal's, in centimetres, in this component's own frame; forces are newtons. Set
/// the properties, name the tool's component, and the bone is opened when play begins. A haptic device's own
/// thread may call Session().SetToolPose and Evaluate, which never wait.
UCLASS(ClassGroup = (Osteon), meta = (BlueprintSpawnableComponent))
class OSTEONCUTTING_API UOsteonBoneComponent : public UProceduralMeshComponent {
  GENERATED_BODY()

 public:
  UOsteonBoneComponent(const FObjectInitializer& Initializer);

  /// A shipped scene: acetabulum, molar, femoral_canal, …
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Osteon")
  FString Scene = TEXT("acetabulum");
  /// A shipped tool: reamer, twist_drill, round_burr, …
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Osteon")
  FString ToolName = TEXT("reamer");
  /// In millimetres; 0: the tool's usual one.
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Osteon")
  double ToolDiameter_mm = 0.0;
  /// Largest force of the hand: above 0, at most 200.
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Osteon")
  double MaxForce_N = 200.0;
  /// Folder of scenes/, tools/ and materials/; empty: that of the library.
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Osteon")
  FString ConfigFolder;
  /// Whether the spindle turns.
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Osteon")
  bool bSpins = true;
  /// Its origin is the tool's apex, its +z the feed. None: poses come by SetToolPose.
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Osteon")
  USceneComponent* Tool = nullptr;

  /// Something was refused; the text says what was found and what is accepted. Each text once in a row.
  UPROPERTY(BlueprintAssignable, Category = "Osteon")
  FOsteonRefused OnRefused;

  /// Something that the scene watches: "breakthrough", "wall too thin", …; each tick looks for it.
  UPROPERTY(BlueprintAssignable, Category = "Osteon")
  FOsteonSceneEvent OnSceneEvent;

  /// Opens bone, tool and session by the properties; what was open is closed.
  UFUNCTION(BlueprintCallable, Category = "Osteon")
  bool Open();
  UFUNCTION(BlueprintCallable, Category = "Osteon")
  void Close();
  UFUNCTION(BlueprintPure, Category = "Osteon")
  bool IsOpen() const { return HostSession.IsOpen(); }

  /// The engine that computes the frames, such as "cpu on one thread, …".
  UFUNCTION(BlueprintPure, Category = "Osteon")
  FString GetEngine() const;
  /// The assumptions that made a solid of the bone's mesh; empty: nothing. It goes to the log as well.
  UFUNCTION(BlueprintPure, Category = "Osteon")
  FString GetBoneWarning() const;
  UFUNCTION(BlueprintPure, Category = "Osteon")
  static FString GetLibraryVersion();

  /// Where the tool is, in this component's frame.
  UFUNCTION(BlueprintCallable, Category = "Osteon")
  bool SetToolPose(const FTransform& Pose);
  /// The force [N] that the hand should feel at this pose, at rest.
  UFUNCTION(BlueprintCallable, Category = "Osteon")
  FVector GetForce(const FTransform& Pose);
  /// Force [N] and torque [N·m] on a tool that moves: Velocity of its apex [cm/s], AngularVelocity [rad/s].
  UFUNCTION(BlueprintCallable, Category = "Osteon")
  bool GetWrench(const FTransform& Pose, const FVector& Velocity, const FVector& AngularVelocity,
                 FVector& Force_N, FVector& Torque_Nm);
  /// From the next GetForce or GetWrench on these parts give way.
  UFUNCTION(BlueprintCallable, Category = "Osteon")
  bool SetCompliance(const FOsteonCompliance& Compliance);
  /// Displacements after the newest GetForce or GetWrench.
  UFUNCTION(BlueprintCallable, Category = "Osteon")
  FOsteonDeflection GetDeflection();
  /// Another tool from now on, at this pose, which must be free of bone. 0 mm: its usual diameter.
  UFUNCTION(BlueprintCallable, Category = "Osteon")
  bool ChangeTool(const FString& Name, double Diameter_mm, const FTransform& Pose);
  /// Saves the carved bone.
  UFUNCTION(BlueprintCallable, Category = "Osteon")
  bool Save(const FString& File);
  /// Returns to a saved bone; the tool, at this pose, must be free of it.
  UFUNCTION(BlueprintCallable, Category = "Osteon")
  bool Restore(const FString& File, const FTransform& Pose);
  /// Writes the carved bone as one mesh in millimetres, in Osteon's axes: .stl, .ply or .obj.
  UFUNCTION(BlueprintCallable, Category = "Osteon")
  bool ExportSurface(const FString& File);
  /// Measures the bone as it is, beside a plan ("acetabulum", or a YAML file); 0.1 s. An empty rubric: by the
  /// plan's kind.
  UFUNCTION(BlueprintCallable, Category = "Osteon")
  bool Assess(const FString& Plan, const FString& Rubric, double& Score, TArray<FOsteonScoreItem>& Items);
  /// A pose that points into the site, its apex Height_cm above the site's centre.
  UFUNCTION(BlueprintCallable, Category = "Osteon")
  FTransform Approach(double Height_cm);
  UFUNCTION(BlueprintCallable, Category = "Osteon")
  double GetRemovedVolume_mm3();
  /// Remembers the bone for Undo.
  UFUNCTION(BlueprintCallable, Category = "Osteon")
  bool Mark();
  /// Returns to the last mark; the tool, at this pose, must be free of the bone that comes back.
  UFUNCTION(BlueprintCallable, Category = "Osteon")
  bool Undo(const FTransform& Pose);
  /// Brings the mesh up to date; each tick does.
  UFUNCTION(BlueprintCallable, Category = "Osteon")
  void UpdateMesh();

  osteon::host::Session& Session() { return HostSession; }

  void BeginPlay() override;
  void EndPlay(const EEndPlayReason::Type Reason) override;
  void TickComponent(float DeltaTime, ELevelTick TickType,
                     FActorComponentTickFunction* ThisTickFunction) override;

 private:
  bool Succeeds(OsteonResult Result);
  void TellEvents();

  osteon::host::Session HostSession{osteon::host::kUnreal};
  TMap<uint32, int32> Sections;  // by the brick's number
  FString LastRefusal;
};
