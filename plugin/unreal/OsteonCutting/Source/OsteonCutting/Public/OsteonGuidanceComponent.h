#pragma once

#include "Components/SceneComponent.h"
#include "CoreMinimal.h"
#include "OsteonTypes.h"
#include "osteon_host_plan.h"

#include "OsteonGuidanceComponent.generated.h"

/// Guidance that keeps a hand to a surgical plan, for one of the plan's reamers: it bounds the sideways
/// distance (a funnel), the tilt (a cone) and the depth.
///
/// Positions and velocities are in Unreal's axes and centimetres, in the bone's frame; forces are in newtons.
/// The plan is opened when play begins. A haptic device's own thread may call Evaluate every millisecond;
/// Evaluate never waits.
UCLASS(ClassGroup = (Osteon), meta = (BlueprintSpawnableComponent))
class OSTEONCUTTING_API UOsteonGuidanceComponent : public USceneComponent {
  GENERATED_BODY()

 public:
  UOsteonGuidanceComponent(const FObjectInitializer& Initializer) : USceneComponent(Initializer) {}

  /// A shipped plan, or its YAML file.
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Osteon")
  FString Plan = TEXT("acetabulum");
  /// Folder of plans/ and rubrics/; empty: that of the library.
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Osteon")
  FString ConfigFolder;
  /// Index of the reamer in use, in the order of the plan.
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Osteon")
  int32 Reamer = 0;
  /// Gain of the guidance, 0 … 1; negative: that of the plan.
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Osteon")
  double Gain = -1.0;
  /// Largest force [N] of guidance and bone together: above 0, at most 200.
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Osteon")
  double MaxForce_N = 200.0;

  /// A call was refused; the text says what was found and what is accepted. If the same text repeats, it is
  /// sent only once.
  UPROPERTY(BlueprintAssignable, Category = "Osteon")
  FOsteonRefused OnRefused;

  /// Opens the plan and its guidance with the values of the properties; closes an open plan first.
  UFUNCTION(BlueprintCallable, Category = "Osteon")
  bool Open();
  UFUNCTION(BlueprintCallable, Category = "Osteon")
  void Close();
  UFUNCTION(BlueprintPure, Category = "Osteon")
  bool IsOpen() const { return HostGuidance.IsOpen(); }

  /// Computes force [N] and torque [N·m] of the guidance, to be added to the bone's force and torque (the
  /// "other" ones), which take precedence at the limits. Call it once per period.
  UFUNCTION(BlueprintCallable, Category = "Osteon")
  bool Evaluate(const FTransform& Pose, const FVector& Velocity, const FVector& AngularVelocity,
                const FVector& OtherForce_N, const FVector& OtherTorque_Nm, FVector& Force_N,
                FVector& Torque_Nm);
  /// How much deeper than planned the tool was in the last Evaluate [mm]; 0 or negative: not deeper.
  UFUNCTION(BlueprintPure, Category = "Osteon")
  double GetDepth_mm() const { return 1e3 * Last.depth_m; }
  /// Whether the tool was beyond a stop of the plan in the last Evaluate. If so, the caller should stop the
  /// spindle.
  UFUNCTION(BlueprintPure, Category = "Osteon")
  bool MustStopSpindle() const { return Last.stop_spindle != 0; }
  UFUNCTION(BlueprintCallable, Category = "Osteon")
  bool SetGain(double NewGain);
  /// Sets the age [s] of the contact model from which the bone's force was computed. The guidance fades out
  /// with this age.
  UFUNCTION(BlueprintCallable, Category = "Osteon")
  bool SetModelAge(double Age_s);
  /// Restarts the guidance. Call it after a change of tool or a jump of the pose.
  UFUNCTION(BlueprintCallable, Category = "Osteon")
  bool Reset();

  UFUNCTION(BlueprintPure, Category = "Osteon")
  int32 GetReamerCount() const { return static_cast<int32>(Info.values.reamer_count); }
  /// The unit axis of the cup, pointing out of its opening.
  UFUNCTION(BlueprintPure, Category = "Osteon")
  FVector GetCupAxis() const;
  UFUNCTION(BlueprintPure, Category = "Osteon")
  FVector GetCupCenter() const;
  /// Planned position of a reamer's apex, and the reamer's diameter.
  UFUNCTION(BlueprintCallable, Category = "Osteon")
  bool GetReamer(int32 Index, FVector& Apex, double& Diameter_mm);

  void BeginPlay() override;
  void EndPlay(const EEndPlayReason::Type Reason) override;

 private:
  // Whether a call succeeded; logs and broadcasts a refusal (OsteonRefusal.h).
  bool Succeeds(OsteonResult Result);

  osteon::host::Plan HostPlan{osteon::host::kUnreal};
  osteon::host::Guidance HostGuidance{osteon::host::kUnreal};
  osteon::host::PlanInfo Info{};
  OsteonGuidanceOutput Last{};  // result of the last Evaluate
  FString LastRefusal;
};
