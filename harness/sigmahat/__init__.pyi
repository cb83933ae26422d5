"""The public names, for lazy_loader and type checkers; see __init__.py."""

from .checks.check import check as check
from .checks.findings import Checked as Checked
from .checks.findings import Finding as Finding
from .estimator.estimator import Estimator as Estimator
from .experiments.metrics import Indices as Indices
from .experiments.metrics import indices as indices
from .experiments.metrics import mean_error as mean_error
from .experiments.metrics import mse as mse
from .experiments.metrics import msrep as msrep
from .experiments.scenario import Comparison as Comparison
from .experiments.scenario import Scenario as Scenario
from .experiments.scenario import Sine as Sine
from .experiments.scenario import Sines as Sines
from .experiments.simulation import run as run
from .fmi.installed import fmu as fmu
from .fmi.master import EstimatorFmu as EstimatorFmu
from .fmi.master import Plant as Plant
from .fmi.master import Recording as Recording
from .fmi.master import simulate as simulate
from .fmi.model import FmuError as FmuError
from .fmi.series import Series as Series
from .motor.identify import identify as identify
from .motor.quantities import Identified as Identified
from .motor.quantities import Quantity as Quantity
from .paper.scenarios import scenario as scenario
from .plant_fmu.plant_fmu import PlantVariable as PlantVariable
from .plant_fmu.plant_fmu import write_plant_fmu as write_plant_fmu
from .plants.equations import PlantEquations as PlantEquations
from .plants.equations import encoder as encoder
from .recording.configuration import Configuration as Configuration
from .recording.configuration import Port as Port
from .recording.configuration import Time as Time
from .recording.configuration import read_configuration as read_configuration
from .recording.log import Log as Log
from .recording.log import LogError as LogError
from .recording.readers.formats import open_log as open_log
from .result.curve import Branch as Branch
from .result.curve import Curve as Curve
from .result.estimate import Estimate as Estimate
from .result.estimate import estimate as estimate
from .result.sheet import Polynomial as Polynomial
from .result.validate import Agreement as Agreement
from .result.validate import TorqueError as TorqueError
from .result.validate import Validation as Validation
from .result.validate import validate as validate

__all__: list[str]
__version__: str
